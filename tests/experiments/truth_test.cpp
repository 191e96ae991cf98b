// Where rays truly meet primitives: by hand-made cases, and the filtered arithmetic against the rational one.

#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/scene/scene.h"
#include "experiments/verify/cone_truth.h"
#include "experiments/verify/polygon_truth.h"
#include "experiments/verify/sphere_truth.h"
#include "experiments/verify/triangle_truth.h"
#include "tests/support/random.h"

namespace raymeter {
namespace {

using test::Random;
using verify::Arithmetic;
using verify::true_hits;
using verify::TrueHits;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr verify::TriangleShape kTriangle{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
constexpr verify::SphereShape kSphere{{0, 0, 0}, 1};
constexpr verify::ConeShape kCylinder{{0, 0, 0}, {0, 2, 0}, {1, 1}};
constexpr verify::ConeShape kCone{{0, 0, 0}, {0, 2, 0}, {1, 0}};
const verify::PolygonShape kSquare{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {0, 0, 1}};

Ray down(float x, float y, float t_min = 0, float t_max = kInf) { return {{x, y, 3}, t_min, {0, -0.0f, -1}, t_max}; }
/// Along +z from z = -3.
Ray up(float x, float y) { return {{x, y, -3}, 0, {0, 0, 1}, kInf}; }

TEST(TriangleTruth, EdgesAndVerticesBelong) {
  for (const auto& [x, y] : {std::pair{0.0f, 0.0f}, {1.0f, 0.0f}, {0.0f, 1.0f}, {0.5f, 0.5f}, {0.25f, 0.0f}, {0.25f, 0.25f}}) {
    const TrueHits hits = true_hits(down(x, y), kTriangle);
    ASSERT_EQ(hits.count, 1) << x << ' ' << y;
    EXPECT_EQ(hits.t[0], 3);
  }
  const float below_zero = -0x1p-149f, above_half = std::nextafter(0.5f, 1.0f);
  EXPECT_EQ(true_hits(down(below_zero, 0.5f), kTriangle).count, 0);
  EXPECT_EQ(true_hits(down(above_half, 0.5f), kTriangle).count, 0);
}

TEST(TriangleTruth, IntervalIsClosed) {
  EXPECT_EQ(true_hits(down(0.25f, 0.25f, 3, 3), kTriangle).count, 1);
  EXPECT_EQ(true_hits(down(0.25f, 0.25f, std::nextafter(3.0f, 4.0f)), kTriangle).count, 0);
  EXPECT_EQ(true_hits(down(0.25f, 0.25f, 0, std::nextafter(3.0f, 0.0f)), kTriangle).count, 0);
  EXPECT_EQ(true_hits(down(0.25f, 0.25f, -kInf, kInf), kTriangle).count, 1);
}

TEST(TriangleTruth, CoplanarRaysAndZeroAreaMiss) {
  EXPECT_EQ(true_hits({{-1, 0.25f, 0}, 0, {1, 0, 0}, kInf}, kTriangle).count, 0);
  EXPECT_EQ(true_hits(down(0.5f, 0), verify::TriangleShape{{{0, 0, 0}, {1, 0, 0}, {0.5f, 0, 0}}}).count, 0);
  EXPECT_EQ(true_hits(down(0, 0), verify::TriangleShape{{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}}).count, 0);
}

TEST(SphereTruth, ATangentRayMeetsOnce) {
  const TrueHits through = true_hits(up(0, 0), kSphere);
  ASSERT_EQ(through.count, 2);
  EXPECT_EQ(through.t[0], 2);
  EXPECT_EQ(through.t[1], 4);
  const TrueHits tangent = true_hits(up(1, 0), kSphere);
  ASSERT_EQ(tangent.count, 1);
  EXPECT_EQ(tangent.t[0], 3);
  EXPECT_EQ(true_hits(up(std::nextafter(1.0f, 2.0f), 0), kSphere).count, 0);
  EXPECT_EQ(true_hits({{0, 0, 0}, 0, {0, 0, 2}, kInf}, kSphere).count, 1);
  EXPECT_EQ(true_hits({{0, 0, -1}, 0, {0, 0, -1}, kInf}, kSphere).count, 1);  // starts on it, leaves
  EXPECT_EQ(true_hits(up(0, 0), verify::SphereShape{{0, 0, 0}, 0}).count, 1);
}

TEST(ConeTruth, RimsBelongAndTheCapsAreOpen) {
  const Ray across{{-3, 1, 0}, 0, {1, 0, 0}, kInf};
  ASSERT_EQ(true_hits(across, kCylinder).count, 2);
  EXPECT_EQ(true_hits(across, kCylinder).t[0], 2);
  EXPECT_EQ(true_hits({{-3, 0, 0}, 0, {1, 0, 0}, kInf}, kCylinder).count, 2);
  EXPECT_EQ(true_hits({{-3, -0x1p-149f, 0}, 0, {1, 0, 0}, kInf}, kCylinder).count, 0);
  EXPECT_EQ(true_hits({{0.5f, -1, 0}, 0, {0, 1, 0}, kInf}, kCylinder).count, 0);  // along the axis, inside
  EXPECT_EQ(true_hits({{1, -1, 0}, 0, {0, 1, 0}, kInf}, kCylinder).count, 0);     // in the surface
  EXPECT_EQ(true_hits(across, kCone).t[0], 2.5);
  EXPECT_EQ(true_hits({{0.5f, -1, 0}, 0, {0, 1, 0}, kInf}, kCone).t[0], 2);  // x = 0.5 at height 1
  EXPECT_EQ(true_hits({{-3, 2, 0}, 0, {1, 0, 0}, kInf}, kCone).t[0], 3);     // the apex
  EXPECT_EQ(true_hits(across, verify::ConeShape{{0, 1, 0}, {0, 0, 0}, {1, 1}}).count, 0);
  const TrueHits parallel = true_hits({{-2, 4, 0}, 0, {1, -2, 0}, kInf}, kCone);  // parallel to one side: one root
  ASSERT_EQ(parallel.count, 1);
  EXPECT_EQ(parallel.t[0], 1.5);
}

TEST(PolygonTruth, OutlineBelongsAndConcaveCornersAreOutside) {
  for (const auto& [x, y] : {std::pair{0.0f, 0.0f}, {1.0f, 1.0f}, {1.0f, 0.5f}, {0.5f, 0.0f}, {0.5f, 0.5f}}) {
    const TrueHits hits = true_hits(down(x, y), kSquare);
    ASSERT_EQ(hits.count, 1) << x << ' ' << y;
    EXPECT_EQ(hits.t[0], 3);
  }
  EXPECT_EQ(true_hits(down(std::nextafter(1.0f, 2.0f), 0.5f), kSquare).count, 0);
  EXPECT_EQ(true_hits({{-1, 0.5f, 0}, 0, {1, 0, 0}, kInf}, kSquare).count, 0);
  const verify::PolygonShape notched{{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 1, 0}, {0, 4, 0}}, {0, 0, 1}};
  EXPECT_EQ(true_hits(down(2, 2), notched).count, 0);
  EXPECT_EQ(true_hits(down(2, 1), notched).count, 1);
  EXPECT_EQ(true_hits(down(3.5f, 2), notched).count, 1);
}

/// Doubles, rounded to floats that are stored: the optimiser cannot drop the rounding of what is in memory (see SlpTrap below).
float stored(double value) {
  volatile float f = static_cast<float>(value);
  return f;
}

void set(float (&out)[3], const glm::dvec3& p) {
  for (int a = 0; a < 3; ++a) out[a] = stored(p[a]);
}

/// Rays at points of a shape: random ones, and points on a coarse grid, where signs vanish.
Ray aimed(Random& random, const glm::dvec3& at, int round) {
  Ray ray{{}, 0, {}, kInf};
  const bool lattice = round % 3 == 0;
  const auto snap = [&](const glm::dvec3& p) { return lattice ? glm::round(p * 4.0) / 4.0 : p; };
  const glm::dvec3 org = snap(random.in_cube(3));
  set(ray.org, org);
  set(ray.dir, lattice ? snap(at) - org : (at - org) * std::exp2(random.uniform(-20, 20)));
  if (round % 7 == 0) ray.t_max = 1;
  if (round % 11 == 0) ray.t_min = -1;
  if (ray.dir[0] == 0 && ray.dir[1] == 0 && ray.dir[2] == 0) ray.dir[round % 3] = 1;
  return ray;
}

/// The filtered decision is the rational one, on `rounds` rays; shape() makes a shape and a point to aim at.
template <class MakeShape>
void expect_filter_agrees(int rounds, std::uint64_t seed, MakeShape make_shape) {
  Random random(seed);
  int met = 0;
  for (int round = 0; round < rounds; ++round) {
    glm::dvec3 at;
    const auto shape = make_shape(random, round, at);
    const Ray ray = aimed(random, at, round);
    const TrueHits fast = true_hits(ray, shape, Arithmetic::filtered), exact = true_hits(ray, shape, Arithmetic::rational);
    ASSERT_EQ(fast.count, exact.count) << "seed " << seed << " round " << round;
    for (std::size_t k = 0; k < static_cast<std::size_t>(exact.count); ++k) {
      // to_double promises 2^-40 for each of the four numbers that a root is made of.
      ASSERT_NEAR(fast.t[k], exact.t[k], 0x1p-37 * std::abs(exact.t[k])) << "seed " << seed << " round " << round;
    }
    met += exact.count > 0;
  }
  EXPECT_GT(met, rounds / 20) << "the rays hardly meet anything";
}

TEST(OracleFilter, AgreesWithRationals) {
  const auto random_point = [](Random& random, int round) { return round % 3 == 0 ? glm::round(random.in_cube(2) * 4.0) / 4.0 : random.in_cube(2); };
  expect_filter_agrees(6000, 1, [&](Random& random, int round, glm::dvec3& at) {
    verify::TriangleShape shape;
    glm::dvec3 v[3];
    for (int k = 0; k < 3; ++k) set(shape.vertex[k], v[k] = random_point(random, round));
    const double s = random.uniform();
    at = round % 2 == 0 ? v[0] + s * (v[1] - v[0]) : (v[0] + v[1] + v[2]) / 3.0;
    return shape;
  });
  expect_filter_agrees(6000, 2, [&](Random& random, int round, glm::dvec3& at) {
    verify::SphereShape shape{{}, stored(round % 3 == 0 ? 1.0 : random.uniform(0.1, 2))};
    const glm::dvec3 center = random_point(random, round);
    set(shape.center, center);
    at = center + (round % 3 == 0 ? glm::dvec3(1, 0, 0) : random.in_cube(1.5));
    return shape;
  });
  expect_filter_agrees(6000, 3, [&](Random& random, int round, glm::dvec3& at) {
    verify::ConeShape shape{{}, {}, {stored(std::round(random.uniform(0, 8)) / 4), stored(round % 4 == 0 ? 0.0 : random.uniform(0, 2))}};
    const glm::dvec3 base = random_point(random, round), axis = random_point(random, round);
    set(shape.base, base);
    set(shape.axis, axis);
    at = base + random.uniform() * axis + random.in_cube(1);
    return shape;
  });
  expect_filter_agrees(3000, 4, [&](Random& random, int round, glm::dvec3& at) {
    verify::PolygonShape shape{{}, {}};
    const glm::dvec3 corner = random_point(random, round), x = random_point(random, round), y = random_point(random, round);
    for (int k = 0; k < 7; ++k) {
      float p[3];
      set(p, corner + std::cos(k * 0.9) * x + std::sin(k * 0.9) * (k % 2 == 0 ? 1.0 : 0.4) * y);
      shape.vertex.push_back({p[0], p[1], p[2]});
    }
    set(shape.normal, glm::cross(x, y));
    at = round % 2 == 0 ? corner + 0.3 * x : glm::dvec3(shape.vertex[2][0], shape.vertex[2][1], shape.vertex[2][2]);
    return shape;
  });
}

[[gnu::noinline]] glm::dvec3 rounded(const glm::dvec3& p) noexcept { return glm::dvec3(glm::vec3(p)); }

// g++ 12 with -ftree-slp-vectorize leaves out the rounding in this function. An oracle that is fed by such code sees other numbers than the kernels: the flag
// is off for all that makes scenes, rays and truth.
TEST(SlpTrap, RoundingToFloatIsKept) {
  Random random(5);
  Scene scene;
  for (int round = 0; round < 1000; ++round) {
    const glm::dvec3 p = random.in_cube(), q = random.in_cube();
    const glm::dvec3 r = rounded(p);
    for (int a = 0; a < 3; ++a) ASSERT_EQ(r[a], double{stored(p[a])});
    scene.add_cone(p, 1, q, 1);
    for (std::size_t a = 0; a < 3; ++a) {
      const auto axis = static_cast<glm::length_t>(a);
      ASSERT_EQ(scene.pools().cones.axis[a].back(), stored(double{stored(q[axis])} - double{stored(p[axis])}));
    }
  }
}

}  // namespace
}  // namespace raymeter
