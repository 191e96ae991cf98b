#include "experiments/verify/oracle.h"

#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "experiments/verify/verify.h"

namespace raymeter {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

/// Along +z from z = -3.
Ray up(float x, float y) { return {{x, y, -3}, 0, {0, 0, 1}, kInf}; }

/// Two walls of two triangles each, and a sphere between them.
Scene two_walls() {
  Scene scene;
  for (const double z : {0.0, 4.0}) {
    scene.add_triangle({0, 0, z}, {1, 0, z}, {1, 1, z});
    scene.add_triangle({0, 0, z}, {1, 1, z}, {0, 1, z});
  }
  scene.add_sphere({0.75, 0.25, 2}, 0.125);
  scene.finish();
  return scene;
}

TEST(Oracle, AcceptsTheTruth) {
  const Scene scene = two_walls();
  const Oracle oracle(scene);
  const Check hit = oracle.closest(up(0.75f, 0.25f), 3, 0);
  EXPECT_EQ(hit.verdict, Verdict::correct);
  EXPECT_EQ(hit.t_ulp, 0);
  EXPECT_EQ(oracle.closest(up(0.75f, 0.25f), std::nextafter(3.0f, 4.0f), 0).t_ulp, 1);
  EXPECT_EQ(oracle.closest(up(0.5f, 0.5f), 3, 0).verdict, Verdict::correct);  // either side of the diagonal
  EXPECT_EQ(oracle.closest(up(0.5f, 0.5f), 3, 1).verdict, Verdict::correct);
  EXPECT_EQ(oracle.closest(up(2, 0.5f), kInf, -1).verdict, Verdict::correct);
  EXPECT_EQ(oracle.closest({{0, 0, 0}, 0, {0, 0, 0}, 1}, kInf, -1).verdict, Verdict::correct);
  EXPECT_EQ(oracle.any(up(0.75f, 0.25f), 4).verdict, Verdict::correct);
  EXPECT_EQ(oracle.any(up(2, 0.25f), -1).verdict, Verdict::correct);
}

TEST(Oracle, FindsPlantedFaults) {
  const Scene scene = two_walls();
  const Oracle oracle(scene);
  const Ray inside = up(0.75f, 0.25f);
  EXPECT_EQ(oracle.closest(inside, 3, 1).verdict, Verdict::false_hit);         // the other half of the wall
  EXPECT_EQ(oracle.closest(inside, 3.001f, 0).verdict, Verdict::false_hit);    // t off by 1e-3
  EXPECT_EQ(oracle.closest(inside, 3.00003f, 0).verdict, Verdict::false_hit);  // and by 1e-5, relative
  EXPECT_EQ(oracle.closest(inside, 4.875f, 4).verdict, Verdict::wrong_prim);   // the sphere behind the wall
  EXPECT_EQ(oracle.closest(inside, 7, 2).verdict, Verdict::wrong_prim);
  EXPECT_EQ(oracle.closest(inside, kInf, -1).verdict, Verdict::false_miss);
  EXPECT_EQ(oracle.closest(inside, 3, 5).verdict, Verdict::false_hit);  // no such primitive
  EXPECT_EQ(oracle.closest(up(2, 0.5f), 3, 0).verdict, Verdict::false_hit);
  EXPECT_EQ(oracle.any(inside, -1).verdict, Verdict::false_miss);
  EXPECT_EQ(oracle.any(inside, 1).verdict, Verdict::false_hit);
  Ray invalid = inside;
  invalid.org[1] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(oracle.closest(invalid, 3, 0).verdict, Verdict::false_hit);
  Ray short_ray = inside;
  short_ray.t_max = 2.5f;
  EXPECT_EQ(oracle.closest(short_ray, 3, 0).verdict, Verdict::false_hit);
}

TEST(Oracle, TheSecondHitOfASphereIsNotTheNearest) {
  Scene scene;
  scene.add_sphere({0, 0, 0}, 1);
  scene.finish();
  const Oracle oracle(scene);
  EXPECT_EQ(oracle.closest(up(0, 0), 2, 0).verdict, Verdict::correct);
  EXPECT_EQ(oracle.closest(up(0, 0), 4, 0).verdict, Verdict::wrong_prim);
}

TEST(Oracle, SharedEdgesAndVerticesAreNotExcusedButSilhouettesAre) {
  Scene fan;  // about (0, 0, 0), closed, and a wall behind
  for (int k = 0; k < 8; ++k) {
    const double a = k * 0.7853981633974483, b = (k + 1) % 8 * 0.7853981633974483;
    fan.add_triangle({0, 0, 0}, {std::cos(a), std::sin(a), 0.1}, {std::cos(b), std::sin(b), 0.1});
  }
  fan.add_sphere({0, 0, 5}, 1);
  fan.finish();
  const Oracle oracle(fan);
  EXPECT_EQ(oracle.closest(up(0, 0), 3, 0).verdict, Verdict::correct);
  EXPECT_EQ(oracle.closest(up(0, 0), kInf, -1).verdict, Verdict::false_miss);     // through the vertex
  EXPECT_EQ(oracle.closest(up(0, 0), 7, 8).verdict, Verdict::wrong_prim);         // the sphere, through the vertex
  EXPECT_EQ(oracle.closest(up(0.5f, 0), kInf, -1).verdict, Verdict::false_miss);  // through an edge
  EXPECT_EQ(oracle.closest(up(1, 0), 8, 8).verdict, Verdict::correct);            // at the rim a hit may be lost

  Scene ridge;  // two triangles folded back over the edge x = 0
  ridge.add_triangle({0, -1, 0}, {0, 1, 0}, {-1, 0, 1});
  ridge.add_triangle({0, -1, 0}, {0, 1, 0}, {-1, 0, 2});
  ridge.finish();
  const Oracle folded(ridge);
  EXPECT_EQ(folded.closest(up(0, 0), kInf, -1).verdict, Verdict::correct);
  EXPECT_EQ(folded.closest(up(-0.001f, 0), kInf, -1).verdict, Verdict::false_miss);
}

TEST(Oracle, TrianglesAndPolygonsShareEdgesToo) {
  Scene scene;
  const std::array<glm::dvec3, 4> square{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}};
  scene.add_polygon(square);
  scene.add_triangle({1, 0, 0}, {2, 0.5, 0}, {1, 1, 0});
  scene.finish();
  const Oracle oracle(scene);
  EXPECT_EQ(oracle.closest(up(1, 0.5f), 3, 0).verdict, Verdict::correct);
  EXPECT_EQ(oracle.closest(up(1, 0.5f), 3, 1).verdict, Verdict::correct);
  EXPECT_EQ(oracle.closest(up(1, 0.5f), kInf, -1).verdict, Verdict::false_miss);
  EXPECT_EQ(oracle.closest(up(0, 0.5f), kInf, -1).verdict, Verdict::correct);  // a border of the surface
}

TEST(Oracle, TheEndsOfTheIntervalMayDecideEitherWay) {
  const Scene scene = two_walls();
  const Oracle oracle(scene);
  Ray ray = up(0.75f, 0.25f);
  ray.t_max = 3;
  EXPECT_EQ(oracle.closest(ray, 3, 0).verdict, Verdict::correct);
  EXPECT_EQ(oracle.closest(ray, kInf, -1).verdict, Verdict::correct);
  ray.t_max = 3.001f;
  EXPECT_EQ(oracle.closest(ray, kInf, -1).verdict, Verdict::false_miss);
}

TEST(Verify, CountsFaultsAndSamplesBySeed) {
  const Scene scene = two_walls();
  const Oracle oracle(scene);
  RayBatch rays;
  HitBatch hits;
  hits.resize(1000);
  for (std::size_t i = 0; i < 1000; ++i) {
    rays.push_back(up(0.75f, 0.25f));
    hits.t[i] = 3;
    hits.prim[i] = 0;
  }
  for (const std::size_t i : {std::size_t{3}, std::size_t{500}}) hits.prim[i] = -1;
  hits.prim[7] = 1;
  hits.t[8] = std::nextafter(3.0f, 4.0f);
  const Accuracy all = verify_closest(oracle, rays, hits, {1e9, 1, 2});
  EXPECT_EQ(all.rays_checked, 1000);
  EXPECT_EQ(all.false_miss, 2);
  EXPECT_EQ(all.false_hit, 1);
  EXPECT_EQ(all.wrong_prim, 0);
  EXPECT_EQ(all.t_ulp_p50, 0);
  EXPECT_EQ(all.t_ulp_max, 1);
  EXPECT_FALSE(all.ok(0));
  EXPECT_TRUE(all.ok(0.003));
  const Accuracy some = verify_closest(oracle, rays, hits, {5 * 100, 1, 1});
  EXPECT_EQ(some.rays_checked, 100);
  EXPECT_EQ(some.mismatches(), verify_closest(oracle, rays, hits, {5 * 100, 1, 7}).mismatches());
  Column<std::int32_t> blocker(1000, 0);
  EXPECT_TRUE(verify_any(oracle, rays, blocker, {1e9, 1, 2}).ok(0));
  blocker[5] = -1;
  EXPECT_EQ(verify_any(oracle, rays, blocker, {1e9, 1, 2}).false_miss, 1);
}

}  // namespace
}  // namespace raymeter
