// Numerics case 50 in general position: lights on vertices, edges, rims, apexes and in the interior of primitives of 1e-3 to 1e5, near and far, head-on and
// along the surface. No surface hides a light that lies on it; what else stands before the light still does.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "accel/registry.h"
#include "core/bounds/aabb.h"
#include "core/geometry/error_bounds.h"
#include "core/scene/light_target.h"
#include "core/scene/surface.h"
#include "core/trace/trace.h"
#include "tests/support/random.h"
#include "tests/support/test_scenes.h"

namespace raymeter {
namespace {

using glm::dvec3;
using test::Random;

constexpr int kShapes = 600;
constexpr int kOriginsPerLight = 100;

double magnitude(Random& random, double low, double high) { return std::pow(10.0, random.uniform(low, high)); }
dvec3 column(const FloatColumns3& columns, std::size_t i) { return {columns[0][i], columns[1][i], columns[2][i]}; }
dvec3 perpendicular(const dvec3& v, Random& random) { return glm::normalize(glm::cross(v, random.direction())); }

/// A light on a primitive, and the unit normal there, to the outside of what is round.
struct Spot {
  dvec3 light;
  dvec3 normal;
};

/// One primitive with a light on it.
struct Lit {
  Scene scene;
  double size = 0;
  Spot spot;
  double radius = std::numeric_limits<double>::infinity();  ///< of what is round, at the light; 0: all tangent planes of a cone meet there
};

/// At a vertex, on an edge or within.
dvec3 weights(Random& random) {
  double u = random.uniform(), v = random.uniform() * (1 - u);
  switch (random.below(3)) {
    case 0: return {1, 0, 0};
    case 1: return {0, 1 - u, u};
    default: return {1 - u - v, u, v};
  }
}

void add_facet(Lit& lit, bool polygon, const dvec3& at, Random& random) {
  const dvec3 x = lit.size * random.direction(), y = lit.size * magnitude(random, -2, 0) * random.direction();
  const dvec3 c = polygon ? at + x + y : at + y;  // within a polygon's rounding of its plane, as a triangle of its first corners
  if (polygon)
    lit.scene.add_polygon(std::array{at, at + x, c, at + y});
  else
    lit.scene.add_triangle(at, at + x, c);
  const Pools& pools = lit.scene.pools();
  std::array<dvec3, 3> corner;
  for (std::size_t k = 0; k < 3; ++k) corner[k] = polygon ? column(pools.polygons.vertex, k) : column(pools.triangles.vertex[k], 0);
  const dvec3 w = weights(random);
  lit.spot = {w.x * corner[0] + w.y * corner[1] + w.z * corner[2], glm::normalize(glm::cross(corner[1] - corner[0], corner[2] - corner[0]))};
}

void add_ball(Lit& lit, const dvec3& at, Random& random) {
  lit.scene.add_sphere(at, lit.size);
  const dvec3 normal = random.direction();
  lit.radius = lit.size;
  lit.spot = {column(lit.scene.pools().spheres.center, 0) + double{lit.scene.pools().spheres.radius[0]} * normal, normal};
}

void add_cone(Lit& lit, const dvec3& at, Random& random) {
  const double radius = lit.size * magnitude(random, -2, 0), other = random.below(3) == 0 ? 0 : random.below(2) == 0 ? radius : radius * random.uniform(0, 2);
  lit.scene.add_cone(at, radius, at + lit.size * random.direction(), other);
  const ConePool& pool = lit.scene.pools().cones;
  const dvec3 axis = column(pool.axis, 0), outwards = perpendicular(axis, random);
  const double height = random.below(3) == 0 ? double(random.below(2)) : random.uniform();
  const double taper = double{pool.radius[1][0]} - double{pool.radius[0][0]}, there = double{pool.radius[0][0]} + taper * height;
  lit.radius = there;
  lit.spot = {column(pool.base, 0) + height * axis + there * outwards, glm::normalize(outwards - taper / glm::dot(axis, axis) * axis)};
}

Lit lit_shape(PrimKind kind, Random& random) {
  Lit lit;
  lit.size = magnitude(random, -3, 5);
  const dvec3 at = lit.size * magnitude(random, -1, 1.5) * random.in_cube();
  switch (kind) {
    case PrimKind::sphere: add_ball(lit, at, random); break;
    case PrimKind::cone: add_cone(lit, at, random); break;
    default: add_facet(lit, kind == PrimKind::polygon, at, random);
  }
  lit.scene.finish();
  if (random.below(2) == 0) lit.spot.light = dvec3(glm::vec3(lit.spot.light));  // as a file's or a user's
  return lit;
}

/// A surface to be lit, like that of a small primitive.
Surface surface_from(const dvec3& point, double size, Random& random) {
  const dvec3 normal = random.direction();
  return {point, normal, normal, double{kUnitRoundoff} * (16 * size + 2 * (std::abs(point.x) + std::abs(point.y) + std::abs(point.z)))};
}

/// What is to be seen of the light from a point: sure where roundings of either do not matter.
enum class Seen { yes, no, unsure };

Seen expected(const Lit& lit, const dvec3& from) {
  const PrimKind kind = lit.scene.prim(0).kind();
  const dvec3 away = from - lit.spot.light;
  if (kind == PrimKind::triangle || kind == PrimKind::polygon) {
    // Who is himself as near to the plane as kernels err is on no side of it.
    return std::abs(glm::dot(away, lit.spot.normal)) > double{kSurfaceError} * (2 * lit.size + glm::length(lit.spot.light)) ? Seen::yes : Seen::unsure;
  }
  // A light that was rounded sees another tangent plane.
  const double tilt = lit.radius > 0 ? kLightTouch * glm::length(lit.spot.light) / lit.radius : 0;
  const double slack = 0x1p-17 * (glm::length(away) + lit.size + glm::length(lit.spot.light)) + tilt * glm::length(away);
  const Pools& pools = lit.scene.pools();
  if (kind == PrimKind::sphere) {
    const double above = glm::dot(lit.spot.normal, away), out = glm::length(from - column(pools.spheres.center, 0)) - double{pools.spheres.radius[0]};
    if (above > slack || out < -slack) return Seen::yes;
    return out > slack && above < -slack ? Seen::no : Seen::unsure;
  }
  const dvec3 axis = column(pools.cones.axis, 0), f = from - column(pools.cones.base, 0);
  const double height = glm::dot(f, axis) / glm::dot(axis, axis), off_axis = glm::length(f - height * axis);
  const double radius = double{pools.cones.radius[0][0]} + (double{pools.cones.radius[1][0]} - double{pools.cones.radius[0][0]}) * height;
  const bool above = lit.radius > 0 && glm::dot(lit.spot.normal, away) > slack;
  const bool outside_apex = lit.radius == 0 && off_axis > std::max(radius, 0.0) + slack * std::abs(height);
  return above || outside_apex || (height >= 0 && height <= 1 && off_axis < radius - slack) ? Seen::yes : Seen::unsure;
}

/// From all directions and distances, a third of them nearly along the surface.
dvec3 origin_about(const Lit& lit, Random& random) {
  dvec3 dir = random.direction();
  if (random.below(3) == 0) dir += (magnitude(random, -7, 0) - 1) * glm::dot(dir, lit.spot.normal) * lit.spot.normal;
  return lit.spot.light + lit.size * magnitude(random, -2, 2.5) * dir;
}

Column<std::int32_t> blockers(const Scene& scene, const RayBatch& rays, Isa isa) {
  const StructureEntry& list = structure_entry("list");
  const ParamValues params = list.resolve({});
  Column<std::int32_t> blocker;
  trace_any(*list.build(scene, params, 1)->intersector({isa, simd_width(isa), params}), rays, blocker, 1);
  return blocker;
}

using Case = std::tuple<PrimKind, Isa>;
constexpr std::array kKindNames{"sphere", "triangle", "polygon", "cone"};

class LightsOnSurfaces : public testing::TestWithParam<Case> {
protected:
  void SetUp() override {
    if (!available(isa())) GTEST_SKIP() << name(isa()) << " is not available on this machine";
  }
  [[nodiscard]] static PrimKind kind() { return std::get<0>(GetParam()); }
  [[nodiscard]] static Isa isa() { return std::get<1>(GetParam()); }
};

TEST_P(LightsOnSurfaces, AreNotHiddenByThem) {
  Random random(50);
  int seen = 0, hidden = 0;
  for (int shape = 0; shape < kShapes; ++shape) {
    const Lit lit = lit_shape(kind(), random);
    const LightTarget target = light_targets(lit.scene, std::array{Light{lit.spot.light}}, 1)[0];
    ASSERT_EQ(target.contacts.size(), 1u) << "shape " << shape;
    RayBatch rays;
    std::vector<Seen> answers;
    for (int k = 0; k < kOriginsPerLight; ++k) {
      const Surface surface = surface_from(origin_about(lit, random), 1e-3 * lit.size, random);
      rays.push_back(spawn_ray_to(surface, target));
      answers.push_back(expected(lit, surface.point));
    }
    const Column<std::int32_t> blocker = blockers(lit.scene, rays, isa());
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (answers[i] == Seen::unsure) continue;
      ++(answers[i] == Seen::yes ? seen : hidden);
      EXPECT_EQ(blocker[i], answers[i] == Seen::yes ? -1 : 0) << "shape " << shape << ", ray " << i;
    }
  }
  EXPECT_GT(seen, kShapes * kOriginsPerLight / (kind() == PrimKind::cone ? 4 : 3));
  EXPECT_EQ(hidden > 0, kind() == PrimKind::sphere) << "its own far side hides it";
}

TEST_P(LightsOnSurfaces, LightTheSurfaceItself) {
  if (kind() == PrimKind::sphere || kind() == PrimKind::cone) GTEST_SKIP() << "round from outside: a surface does not see itself";
  Random random(51);
  for (int shape = 0; shape < kShapes; ++shape) {
    const Lit lit = lit_shape(kind(), random);
    const LightTarget target = light_targets(lit.scene, std::array{Light{lit.spot.light}}, 1)[0];
    RayBatch rays;
    for (int k = 0; k < kOriginsPerLight / 4; ++k) {
      const dvec3 w = weights(random);
      const Pools& pools = lit.scene.pools();
      dvec3 point(0.0);
      for (std::size_t c = 0; c < 3; ++c) {
        point += w[static_cast<glm::length_t>(c)] * (kind() == PrimKind::polygon ? column(pools.polygons.vertex, c) : column(pools.triangles.vertex[c], 0));
      }
      const dvec3 eye = point + (random.below(2) == 0 ? 1 : -1) * lit.size * lit.spot.normal, dir = point - eye;
      const Ray seen{{static_cast<float>(eye.x), static_cast<float>(eye.y), static_cast<float>(eye.z)},
                     0,
                     {static_cast<float>(dir.x), static_cast<float>(dir.y), static_cast<float>(dir.z)},
                     2};
      rays.push_back(spawn_ray_to(surface_at(lit.scene, seen, 1, 0), target));
    }
    const Column<std::int32_t> blocker = blockers(lit.scene, rays, isa());
    for (std::size_t i = 0; i < rays.size(); ++i) EXPECT_EQ(blocker[i], -1) << "shape " << shape << ", ray " << i;
  }
}

/// A small square across a ray at distance `gap` from the light: it hides the light although it is as good as there. Of rays along the surface too.
TEST_P(LightsOnSurfaces, AreHiddenByWhatStandsBeforeThem) {
  Random random(52);
  int checked = 0;
  for (int shape = 0; shape < kShapes; ++shape) {
    Lit lit = lit_shape(kind(), random);
    const dvec3 from = origin_about(lit, random), away = from - lit.spot.light;
    const double distance = glm::length(away), reach = distance + lit.size;
    // Clear of where the ray may end, and of what its direction, the square's corners and the kernels round.
    const double gap = 2 * kLightLift * (reach + lit.size) + 0x1p-20 * glm::length(lit.spot.light);
    if (gap > distance / 4) continue;
    const dvec3 there = lit.spot.light + 2 * gap * (away / distance), x = 4 * gap * perpendicular(away, random);
    const dvec3 y = glm::cross(away / distance, x);
    lit.scene.add_polygon(std::array{there + x, there + y, there - x, there - y});
    RayBatch rays;
    rays.push_back(spawn_ray_to(surface_from(from, 1e-3 * lit.size, random), light_targets(lit.scene, std::array{Light{lit.spot.light}}, 1)[0]));
    ++checked;
    EXPECT_GE(blockers(lit.scene, rays, isa())[0], 0) << "shape " << shape << ", gap " << gap << " of " << distance;
  }
  EXPECT_GT(checked, kShapes / 2);
}

INSTANTIATE_TEST_SUITE_P(All, LightsOnSurfaces,
                         testing::Combine(testing::Values(PrimKind::sphere, PrimKind::triangle, PrimKind::polygon, PrimKind::cone), testing::ValuesIn(kIsas)),
                         [](const auto& chosen) {
                           return std::string(kKindNames[static_cast<std::size_t>(std::get<0>(chosen.param))]) + '_' +
                                  std::string(name(std::get<1>(chosen.param)));
                         });

std::size_t triangles_at(const TrianglePool& pool, const dvec3& vertex) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < pool.size(); ++i) {
    for (const FloatColumns3& columns : pool.vertex) count += column(columns, i) == vertex ? 1 : 0;
  }
  return count;
}

TEST(LightsOnMeshes, AreSeenFromBothSidesAtVerticesEdgesAndFaces) {
  Random random(53);
  for (const double scale : {1e-3, 1.0, 1e5}) {
    const Scene mesh = test::icosphere(2, scale, scale * dvec3(0.3, -1.7, 2.9));
    const TrianglePool& pool = mesh.pools().triangles;
    const dvec3 center = scale * dvec3(0.3, -1.7, 2.9);
    for (int k = 0; k < 200; ++k) {
      const std::size_t i = random.below(pool.size());
      const dvec3 a = column(pool.vertex[0], i), b = column(pool.vertex[1], i), c = column(pool.vertex[2], i), w = weights(random);
      const dvec3 light = w.x * a + w.y * b + w.z * c, normal = glm::normalize(glm::cross(b - a, c - a));
      const LightTarget target = light_targets(mesh, std::array{Light{light}}, 1)[0];
      EXPECT_EQ(target.contacts.size(), w.x == 1 ? triangles_at(pool, a) : w.x == 0 ? 2u : 1u);
      RayBatch rays;
      for (int j = 0; j < 50; ++j) {
        dvec3 outside = light + scale * magnitude(random, -2, 3) * random.direction();
        if (glm::dot(outside - light, normal) < 0) outside -= 2 * glm::dot(outside - light, normal) * normal;
        rays.push_back(spawn_ray_to(surface_from(outside, 0.1 * scale, random), target));
        rays.push_back(spawn_ray_to(surface_from(center + 0.9 * scale * random.uniform() * random.direction(), 0.1 * scale, random), target));
      }
      for (const Isa isa : kIsas) {
        if (!available(isa)) continue;
        const Column<std::int32_t> blocker = blockers(mesh, rays, isa);
        for (std::size_t j = 0; j < rays.size(); ++j) EXPECT_EQ(blocker[j], -1) << name(isa) << ", scale " << scale << ", light " << k << ", ray " << j;
      }
    }
  }
}

}  // namespace
}  // namespace raymeter
