#include "core/scene/surface.h"

#include <gtest/gtest.h>

#include <cmath>

#include <glm/geometric.hpp>

#include "accel/registry.h"
#include "core/base/random.h"
#include "core/trace/trace.h"

namespace raymeter {
namespace {

glm::dvec3 random_point(RandomStream& random) { return {2 * random.uniform() - 1, 2 * random.uniform() - 1, 2 * random.uniform() - 1}; }

/// Coordinates of magnitude 10^-8 to 10^8, as in pbrt's tests of spawned rays.
glm::dvec3 wild_point(RandomStream& random) {
  glm::dvec3 p;
  for (glm::length_t a = 0; a < 3; ++a) p[a] = (random.uniform() < 0.5 ? -1 : 1) * std::pow(10.0, 16 * random.uniform() - 8);
  return p;
}

void add_random_prim(Scene& scene, int kind, RandomStream& random) {
  const glm::dvec3 a = wild_point(random), b = wild_point(random), c = wild_point(random);
  const double size = std::pow(10.0, 8 * random.uniform() - 4);
  switch (kind) {
    case 0: return scene.add_sphere(a, size);
    case 1: return scene.add_triangle(a, b, c);
    case 2: return scene.add_polygon(std::array<glm::dvec3, 4>{a, b, b + c - a, c});
    default: return scene.add_cone(a, size, a + size * 4 * random_point(random), size * random.uniform());
  }
}

/// Aims at a point of the primitive's own surface, so that rays meet it whatever its shape.
Ray aimed(const Scene& scene, RandomStream& random) {
  const Pools& pools = scene.pools();
  const auto at = [](const FloatColumns3& columns, std::size_t i) { return glm::dvec3(columns[0][i], columns[1][i], columns[2][i]); };
  glm::dvec3 target, reach;
  if (pools.spheres.size() > 0) {
    reach = double{pools.spheres.radius[0]} * random_point(random);
    target = at(pools.spheres.center, 0) + 0.5 * reach;
  } else if (pools.cones.size() > 0) {
    reach = double{pools.cones.radius[0][0]} * random_point(random);
    target = at(pools.cones.base, 0) + random.uniform() * at(pools.cones.axis, 0) + 0.5 * reach;
  } else if (pools.triangles.size() > 0) {
    const glm::dvec3 a = at(pools.triangles.vertex[0], 0), ab = at(pools.triangles.vertex[1], 0) - a, ac = at(pools.triangles.vertex[2], 0) - a;
    const double u = random.uniform();
    target = a + u * ab + (1 - u) * random.uniform() * ac;
    reach = glm::length(ab) * random_point(random);
  } else {
    const glm::dvec3 a = at(pools.polygons.vertex, 0), ab = at(pools.polygons.vertex, 1) - a, ac = at(pools.polygons.vertex, 3) - a;
    target = a + random.uniform() * ab + random.uniform() * ac;
    reach = glm::length(ab) * random_point(random);
  }
  const glm::vec3 org(target + 3.0 * reach), dir(target - glm::dvec3(org));
  return {{org.x, org.y, org.z}, 0, {dir.x, dir.y, dir.z}, std::numeric_limits<float>::infinity()};
}

/// How far the point is from the primitive's own surface (spheres, planes), relative to its distance from the origin of coordinates and its size.
double off_surface(const Scene& scene, const Surface& surface) {
  const Pools& pools = scene.pools();
  const auto at = [](const FloatColumns3& columns, std::size_t i) { return glm::dvec3(columns[0][i], columns[1][i], columns[2][i]); };
  double distance = 0, size = 1;
  if (pools.spheres.size() > 0) {
    size = double{pools.spheres.radius[0]} + glm::length(surface.point);
    distance = glm::length(surface.point - at(pools.spheres.center, 0)) - double{pools.spheres.radius[0]};
  } else if (pools.triangles.size() > 0) {
    const glm::dvec3 a = at(pools.triangles.vertex[0], 0);
    size = glm::length(surface.point) + glm::length(a);
    distance = glm::dot(surface.geometric, surface.point - a);
  }
  return std::abs(distance) / size;
}

/// What a ray from the surface may be sent to: anywhere, or where it comes back to within roundings of the surface's own plane, to either side.
glm::dvec3 wild_target(const Surface& surface, RandomStream& random) {
  const double reach = std::pow(10.0, 16 * random.uniform() - 8);
  glm::dvec3 away = reach * random_point(random);
  if (random.uniform() < 0.5) away -= (1 - 0x1p-24 * (4 * random.uniform() - 2)) * glm::dot(away, surface.geometric) * surface.geometric;
  return surface.point + away;
}

/// `count` rays that leave what `seen` met at `t`: by direction, and to targets. From spheres and cones to the outside.
void spawn_from(const Scene& scene, int kind, const Ray& seen, float t, int count, RandomStream& random, RayBatch& leaving) {
  const Surface surface = surface_at(scene, seen, t, 0);
  EXPECT_LT(off_surface(scene, surface), 0x1p-45);  // 2^8 roundings in double
  EXPECT_NEAR(glm::length(surface.geometric), 1, 1e-12);
  const bool two_sided = kind == 1 || kind == 2;
  for (int j = 0; j < count; ++j) {
    const bool to_target = j % 2 != 0;
    glm::dvec3 dir = to_target ? wild_target(surface, random) - surface.point : random_point(random);
    if (!two_sided && glm::dot(dir, surface.geometric) < 0) dir = glm::reflect(dir, surface.geometric);
    const glm::dvec3 target = surface.point + dir;
    if (!two_sided && to_target && glm::dot(surface.geometric, target - surface.point) < 0) continue;  // as it is rounded
    leaving.push_back(to_target ? spawn_ray_to(surface, target) : spawn_ray(surface, dir));
  }
}

// Numerics case 59: 500 primitives of each kind with coordinates 10^U(-8, 8), and rays that leave each from where random rays meet it; a million on each
// instruction set. On a convex side none may come back: from spheres outwards, from planes to either side, from cones outwards as far as the line does not
// enter the cone elsewhere.
TEST(Surface, SpawnedRaysDoNotMeetWhatTheyLeave) {
  constexpr int kPrims = 500, kAims = 12, kLeaving = 60;
  const std::uint64_t seed = 59;
  const TechniqueSpec list = parse_technique("list");
  for (const Isa isa : kIsas) {
    if (!available(isa)) continue;
    std::int64_t spawned = 0;
    for (int k = 0; k < 4 * kPrims; ++k) {
      const int kind = k / kPrims;
      RandomStream random(seed, static_cast<std::uint64_t>(k));
      Scene scene;
      add_random_prim(scene, kind, random);
      const auto structure = list.structure->build(scene, list.params, 1);
      const auto tracer = structure->intersector({isa, 16, list.params});
      RayBatch aims, leaving;
      for (int i = 0; i < kAims; ++i) aims.push_back(aimed(scene, random));
      HitBatch hits;
      trace_closest(*tracer, aims, hits, 1);
      for (std::size_t i = 0; i < aims.size(); ++i) {
        if (hits.prim[i] >= 0) spawn_from(scene, kind, aims[i], hits.t[i], kLeaving, random, leaving);
      }
      trace_closest(*tracer, leaving, hits, 1);
      spawned += static_cast<std::int64_t>(leaving.size());
      for (std::size_t i = 0; i < leaving.size(); ++i) {
        EXPECT_EQ(hits.prim[i], -1) << "kind " << kind << ", primitive " << k << ", ray " << i << ", " << name(isa) << ", t " << hits.t[i];
      }
    }
    EXPECT_GE(spawned, 1'000'000) << name(isa);
  }
}

TEST(Surface, NormalsPointOutAndInterpolate) {
  Scene scene;
  scene.add_sphere({1, 2, 3}, 2);
  scene.add_cone({0, 0, 0}, 2, {0, 0, 2}, 0);
  scene.add_triangle({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, {{{1, 0, 1}, {0, 1, 1}, {0, 0, 1}}});
  const Surface sphere = surface_at(scene, {{1, 2, 9}, 0, {0, 0, -1}, 99}, 4, 0);
  EXPECT_EQ(sphere.geometric, glm::dvec3(0, 0, 1));
  EXPECT_EQ(sphere.point, glm::dvec3(1, 2, 5));
  const Surface inside = surface_at(scene, {{1, 2, 3}, 0, {0, 0, -1}, 99}, 2, 0);
  EXPECT_EQ(inside.geometric, glm::dvec3(0, 0, -1));
  const Surface cone = surface_at(scene, {{9, 0, 1}, 0, {-1, 0, 0}, 99}, 8, 1);  // 45 degrees: the normal leans to the apex
  EXPECT_NEAR(cone.geometric.x, std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(cone.geometric.z, std::sqrt(0.5), 1e-15);
  const Surface triangle = surface_at(scene, {{0.5, 0.5, 1}, 0, {0, 0, -1}, 99}, 1, 2);  // midway between vertices 1 and 2
  EXPECT_EQ(triangle.geometric, glm::dvec3(0, 0, 1));
  EXPECT_NEAR(glm::length(triangle.shading - glm::normalize(glm::dvec3(0, 1, 2))), 0, 1e-15);
}

TEST(Surface, TheLightItselfNeverBlocks) {
  // Case 50: the light lies exactly on another surface, and on the shaded one.
  Scene scene;
  scene.add_polygon(std::array<glm::dvec3, 4>{{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}});
  scene.add_polygon(std::array<glm::dvec3, 4>{{{-1, -1, 2}, {1, -1, 2}, {1, 1, 2}, {-1, 1, 2}}});
  const Surface floor = surface_at(scene, {{0.5, 0.25, 1}, 0, {0, 0, -1}, 99}, 1, 0);
  const TechniqueSpec list = parse_technique("list");
  const auto structure = list.structure->build(scene, list.params, 1);
  for (const Isa isa : kIsas) {
    if (!available(isa)) continue;
    const auto tracer = structure->intersector({isa, 16, list.params});
    RayBatch rays;
    for (const glm::dvec3& light : {glm::dvec3(0.5, 0.25, 2), glm::dvec3(0.25, -0.5, 2), glm::dvec3(-0.25, 0.75, 0), floor.point, glm::dvec3(0.5, 0.25, 4)}) {
      rays.push_back(spawn_ray_to(floor, light));
    }
    Column<std::int32_t> blocker;
    trace_any(*tracer, rays, blocker, 1);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(blocker[i], -1) << "light " << i << ' ' << name(isa);
    EXPECT_EQ(blocker[4], 1) << "a surface on the way blocks";
  }
}

}  // namespace
}  // namespace raymeter
