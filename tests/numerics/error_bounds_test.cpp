// The two promises of core/geometry/error_bounds.h, on shapes and rays made to break them: far and near, slender and huge, grazing, in planes of the axes.

#include "core/geometry/error_bounds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "accel/registry.h"
#include "core/bounds/aabb.h"
#include "core/scene/surface.h"
#include "core/trace/trace.h"
#include "experiments/verify/cone_truth.h"
#include "experiments/verify/oracle.h"
#include "experiments/verify/polygon_truth.h"
#include "experiments/verify/sphere_truth.h"
#include "experiments/verify/triangle_truth.h"
#include "tests/support/exact_hits.h"
#include "tests/support/test_rays.h"

namespace raymeter {
namespace {

using test::Random;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr int kShapes = 2500;
constexpr int kRaysPerShape = 400;

double magnitude(Random& random, double low, double high) { return std::pow(10.0, random.uniform(low, high)); }

/// A scene of one primitive of any proportions, at the origin or away from it.
Scene one_shape(PrimKind kind, Random& random) {
  const double size = magnitude(random, -3, 3);
  const glm::dvec3 at = random.below(3) == 0 ? glm::dvec3(0) : size * magnitude(random, -1, 3) * random.in_cube();
  const auto vector = [&] {  // lengths, and axes among directions, that differ widely
    glm::dvec3 v = size * magnitude(random, -3, 0.5) * random.direction();
    if (random.below(4) == 0) v[static_cast<glm::length_t>(random.below(3))] = 0;
    return v;
  };
  Scene scene;
  switch (kind) {
    case PrimKind::sphere: scene.add_sphere(at, size * magnitude(random, -3, 0)); break;
    case PrimKind::triangle: scene.add_triangle(at, at + vector(), at + vector()); break;
    case PrimKind::cone: {
      const double r = size * magnitude(random, -4, 0);
      const glm::dvec3 base = at, apex = at + vector();
      scene.add_cone(base, r, apex, random.below(3) == 0 ? 0 : random.below(2) == 0 ? r : r * random.uniform(0, 2));
      break;
    }
    case PrimKind::polygon: {
      const glm::dvec3 x = vector(), y = vector();
      const int corners = random.below(20) == 0 ? 144 : 3 + static_cast<int>(random.below(9));
      const double notch = random.uniform(0.2, 1);
      std::vector<glm::dvec3> vertices;
      for (int k = 0; k < corners; ++k) {
        const double angle = 2 * std::numbers::pi * k / corners;
        vertices.push_back(at + (k % 2 == 0 ? 1 : notch) * (std::cos(angle) * x + std::sin(angle) * y));
      }
      scene.add_polygon(vertices);
    }
  }
  scene.finish();
  return scene;
}

glm::dvec3 axis_of(const ConePool& cones, std::size_t i) { return {cones.axis[0][i], cones.axis[1][i], cones.axis[2][i]}; }

/// Rays past points of the shape: from 1e-4 to 1e6 of its size away, within a few roundings of the point or right at it, along its surface or in planes of
/// the axes.
RayBatch rays_at(const Scene& scene, Random& random) {
  const PrimRef ref = scene.prim(0);
  const double size = double{glm::length(tight_bounds(scene.pools(), ref).extent())};
  RayBatch rays;
  for (int k = 0; k < kRaysPerShape; ++k) {
    const glm::dvec3 at = test::point_of(scene, ref, random);
    glm::dvec3 dir = random.direction();
    if (k % 4 == 0) {
      const glm::dvec3 along = test::point_of(scene, ref, random) - at;
      if (glm::length(along) > 0) dir = glm::normalize(along) + magnitude(random, -8, 0) * random.direction();
    }
    if (k % 7 == 0 && ref.kind() == PrimKind::cone) dir = axis_of(scene.pools().cones, 0) + magnitude(random, -9, -3) * random.direction();
    if (k % 3 == 0) dir[static_cast<glm::length_t>(random.below(3))] *= random.below(2) == 0 ? 0.0 : magnitude(random, -9, -3);
    if (k % 9 == 0) dir[static_cast<glm::length_t>(random.below(3))] = 0;
    if (dir == glm::dvec3(0)) dir.x = 1;
    const double distance = size * magnitude(random, -4, k % 5 == 0 ? 6 : 2);
    glm::dvec3 org = at - distance * dir;
    if (k % 2 == 0) org += (distance + size) * magnitude(random, -9, -3) * random.direction();
    Ray ray = test::make_ray(org, dir * magnitude(random, -3, 3));
    if (k % 6 == 0) ray.t_min = -kInf;
    rays.push_back(ray);
  }
  return rays;
}

/// Of the scene's one shape: the largest distance of two of its points.
double diameter(const Scene& scene) {
  using namespace verify;
  const Pools& pools = scene.pools();
  std::vector<Point> vertices;
  switch (scene.prim(0).kind()) {
    case PrimKind::sphere: return 2 * double{pools.spheres.radius[0]};
    case PrimKind::cone: {
      const double base = double{pools.cones.radius[0][0]}, apex = double{pools.cones.radius[1][0]};
      return std::max({2 * base, 2 * apex, std::hypot(glm::length(axis_of(pools.cones, 0)), base + apex)});
    }
    case PrimKind::triangle:
      for (const auto& v : triangle_at(pools, 0).vertex) vertices.push_back(point(v));
      break;
    case PrimKind::polygon:
      for (const auto& v : polygon_at(pools, 0).vertex) vertices.push_back({double{v[0]}, double{v[1]}, double{v[2]}});
  }
  double largest = 0;
  for (const Point& p : vertices) {
    for (const Point& q : vertices) largest = std::max(largest, length(minus(p, q)));
  }
  return largest;
}

/// Distance of org + t dir from the shape's surface, in doubles.
double surface_distance(const Scene& scene, const Ray& ray, double t) {
  using namespace verify;
  const Pools& pools = scene.pools();
  const Point org = point(ray.org), dir = point(ray.dir), p = along(org, t, dir);
  switch (scene.prim(0).kind()) {
    case PrimKind::sphere: return distance(sphere_at(pools, 0), p);
    case PrimKind::triangle: return distance(triangle_at(pools, 0), p);
    case PrimKind::polygon: return distance(polygon_at(pools, 0), org, dir, t);
    case PrimKind::cone: return distance(cone_at(pools, 0), p);
  }
  return 0;
}

/// Hits and the largest errors among them, in roundings; what they are relative to stands in error_bounds.h.
struct Errors {
  int hits = 0;
  int beside_box = 0;   ///< hits that break the promise of boxes; exact
  int off_surface = 0;  ///< hits that are not proven to keep that of surfaces
  double worst = 0;     ///< distance from the surface

  void add(const Scene& scene, const Aabb& box, double size, const Ray& ray, double t) {
    ++hits;
    beside_box += test::near_box(box, ray, t) ? 0 : 1;
    double way2 = 0, coordinates = 0;
    for (glm::length_t a = 0; a < 3; ++a) {
      const double way = t * double{ray.dir[a]};
      way2 += way * way;
      coordinates += std::abs(double{ray.org[a]}) + std::abs(way) + std::abs(double{box.min[a]}) + std::abs(double{box.max[a]});
    }
    const double scale = std::sqrt(way2) + size, measured = surface_distance(scene, ray, t);
    worst = std::max(worst, measured / (double{kUnitRoundoff} * scale));
    const double promised = double{kSurfaceError} * scale * (1 - 0x1p-48);
    // Distances in doubles take each coordinate with fewer than 32 roundings; but normals of slender triangles and crossings of grazed planes are worth less.
    bool proven = measured + 0x1p-48 * coordinates <= promised;
    if (scene.prim(0).kind() == PrimKind::triangle) proven = test::near_triangle(verify::triangle_at(scene.pools(), 0), ray, t, promised);
    if (scene.prim(0).kind() == PrimKind::polygon) proven = proven && test::near_polygon(verify::polygon_at(scene.pools(), 0), ray, t, promised);
    off_surface += proven ? 0 : 1;
  }
};

HitBatch trace(const Scene& scene, const RayBatch& rays, Isa isa) {
  const StructureEntry& list = structure_entry("list");
  const ParamValues params = list.resolve({});
  HitBatch hits;
  trace_closest(*list.build(scene, params, 1)->intersector({isa, simd_width(isa), params}), rays, hits, 1);
  return hits;
}

using Case = std::tuple<PrimKind, Isa>;
constexpr std::array kKindNames{"sphere", "triangle", "polygon", "cone"};

class ErrorBounds : public testing::TestWithParam<Case> {
protected:
  void SetUp() override {
    if (!available(isa())) GTEST_SKIP() << name(isa()) << " is not available on this machine";
  }
  [[nodiscard]] static PrimKind kind() { return std::get<0>(GetParam()); }
  [[nodiscard]] static Isa isa() { return std::get<1>(GetParam()); }
};

/// A million hits of each kernel.
TEST_P(ErrorBounds, HoldForAcceptedHits) {
  Random random(21);
  Errors errors;
  while (errors.hits < 1'000'000) {
    const Scene scene = one_shape(kind(), random);
    const RayBatch rays = rays_at(scene, random);
    const HitBatch hits = trace(scene, rays, isa());
    const Aabb box = tight_bounds(scene.pools(), scene.prim(0));
    const double size = diameter(scene);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (hits.prim[i] == 0) errors.add(scene, box, size, rays[i], double{hits.t[i]});
    }
  }
  RecordProperty("hits", errors.hits);
  RecordProperty("off_surface_roundings", std::to_string(errors.worst));
  EXPECT_EQ(errors.beside_box, 0);
  EXPECT_EQ(errors.off_surface, 0);
}

/// What clearances take for the diameter (core/scene/surface.cpp): more than it, for cones and polygons.
double spawning_size(const Pools& pools, PrimRef ref) {
  const std::size_t i = ref.index;
  const auto vertex = [&](std::size_t k) {
    const FloatColumns3& v = pools.triangles.vertex[k % 3];
    return glm::dvec3(v[0][i], v[1][i], v[2][i]);
  };
  switch (ref.kind()) {
    case PrimKind::sphere: return 2 * double{pools.spheres.radius[i]};
    case PrimKind::triangle: return std::max({glm::distance(vertex(0), vertex(1)), glm::distance(vertex(1), vertex(2)), glm::distance(vertex(2), vertex(0))});
    case PrimKind::cone: return glm::length(axis_of(pools.cones, i)) + 2 * double{std::max(pools.cones.radius[0][i], pools.cones.radius[1][i])};
    case PrimKind::polygon: break;
  }
  return glm::length(glm::dvec3(tight_bounds(pools, ref).extent()));
}

/// Rays that start up to 48 roundings of the shape's size above points that rays have met, and move away: anywhere, or all but along the surface.
struct LeavingRays {
  RayBatch rays;
  std::vector<double> height;  ///< of the rounded origin, in roundings of the size

  LeavingRays(const Scene& scene, const RayBatch& seen, const HitBatch& hits, Random& random) {
    const double unit = double{kUnitRoundoff} * spawning_size(scene.pools(), scene.prim(0));
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (hits.prim[i] < 0) continue;
      const Surface surface = surface_at(scene, seen[i], hits.t[i], 0);
      for (int k = 0; k < 3; ++k) {
        const bool below = scene.prim(0).kind() != PrimKind::sphere && scene.prim(0).kind() != PrimKind::cone && random.below(2) == 0;
        const glm::dvec3 up = below ? -surface.geometric : surface.geometric;
        const glm::dvec3 org(glm::vec3(surface.point + random.uniform(0, 48) * unit * up));
        glm::dvec3 dir = random.direction();
        if (k > 0) dir += (k == 1 ? magnitude(random, -9, -2) - glm::dot(dir, up) : -glm::dot(dir, up)) * up;
        dir = glm::dvec3(glm::vec3(dir * magnitude(random, -3, 3)));
        double above = glm::dot(org - surface.point, up) / unit;
        // Polygons lie no better in their planes than their vertices are rounded.
        if (scene.prim(0).kind() == PrimKind::polygon) above -= 2 * double{kUnitRoundoff} * glm::dot(glm::abs(up), glm::abs(surface.point)) / unit;
        if (dir == glm::dvec3(0) || !(above > 0)) continue;
        // What is rounded downwards is turned about: it moves away by as little.
        rays.push_back(test::make_ray(org, glm::dot(dir, up) < 0 ? -dir : dir));
        height.push_back(above);
      }
    }
  }
};

TEST_P(ErrorBounds, WhatARayLeavesItDoesNotMeet) {
  Random random(23);
  std::int64_t leaving = 0;
  double highest = 0;
  for (int shape = 0; leaving < 1'000'000; ++shape) {
    const Scene scene = one_shape(kind(), random);
    const RayBatch seen = rays_at(scene, random);
    const LeavingRays from(scene, seen, trace(scene, seen, isa()), random);
    const HitBatch hits = trace(scene, from.rays, isa());
    leaving += static_cast<std::int64_t>(from.rays.size());
    for (std::size_t i = 0; i < hits.size(); ++i) {
      if (hits.prim[i] == 0) highest = std::max(highest, from.height[i]);
    }
  }
  RecordProperty("leaving_roundings", std::to_string(highest));
  EXPECT_LE(highest, double{kLeavingError / kUnitRoundoff});
}

std::string kind_name(PrimKind kind) { return kKindNames[static_cast<std::size_t>(kind)]; }

constexpr std::array kKinds{PrimKind::sphere, PrimKind::triangle, PrimKind::polygon, PrimKind::cone};

INSTANTIATE_TEST_SUITE_P(Kernels, ErrorBounds, testing::Combine(testing::ValuesIn(kKinds), testing::ValuesIn(kIsas)),
                         [](const testing::TestParamInfo<Case>& at) {
                           return kind_name(std::get<0>(at.param)) + "_" + std::string(name(std::get<1>(at.param)));
                         });

class AllAnswers : public testing::TestWithParam<PrimKind> {};

/// A million rays by every instruction set; the oracle, which takes the time, judges an answer that several give once.
TEST_P(AllAnswers, TheOracleAgrees) {
  Random random(22);
  int checked = 0, isas = 0;
  for (const Isa isa : kIsas) isas += available(isa) ? 1 : 0;
  for (int shape = 0; shape < kShapes; ++shape) {
    const Scene scene = one_shape(GetParam(), random);
    const Oracle oracle(scene);
    const RayBatch rays = rays_at(scene, random);
    std::vector<HitBatch> judged;
    for (const Isa isa : kIsas) {
      if (!available(isa)) continue;
      HitBatch hits = trace(scene, rays, isa);
      for (std::size_t i = 0; i < rays.size(); ++i, ++checked) {
        if (std::ranges::any_of(judged, [&](const HitBatch& other) { return other.t[i] == hits.t[i] && other.prim[i] == hits.prim[i]; })) continue;
        const Verdict verdict = oracle.closest(rays[i], hits.t[i], hits.prim[i]).verdict;
        const Ray ray = rays[i];
        ASSERT_EQ(verdict, Verdict::correct) << std::hexfloat << name(isa) << ", shape " << shape << " ray " << i << ": t " << hits.t[i] << " prim "
                                             << hits.prim[i] << "; org " << ray.org[0] << ' ' << ray.org[1] << ' ' << ray.org[2] << " dir " << ray.dir[0] << ' '
                                             << ray.dir[1] << ' ' << ray.dir[2] << " from " << ray.t_min;
      }
      judged.push_back(std::move(hits));
    }
  }
  EXPECT_EQ(checked, isas * kShapes * kRaysPerShape);
}

INSTANTIATE_TEST_SUITE_P(Kernels, AllAnswers, testing::ValuesIn(kKinds), [](const testing::TestParamInfo<PrimKind>& at) { return kind_name(at.param); });

}  // namespace
}  // namespace raymeter
