// No test of a bounding volume misses a ray that truly meets it: rays aimed at edges and silhouettes, volumes centred and far from the origin.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "accel/registry.h"
#include "core/bounds/aabb_volume.h"
#include "core/bounds/kdop_volume.h"
#include "core/bounds/obb_volume.h"
#include "core/bounds/sphere_volume.h"
#include "core/trace/trace.h"
#include "experiments/cases/recipes.h"
#include "tests/support/random.h"
#include "tests/support/test_rays.h"
#include "tests/support/volume_targets.h"

namespace raymeter {
namespace {

using glm::dvec3;
using test::Count;
using test::Kernels;
using test::kKernels;
using test::Random;
using test::set;
using test::Slab;
using test::Target;
using test::VolumeKernel;

constexpr std::int64_t kRays = 1'000'000;  // that truly meet their volumes, in each place
constexpr int kRaysPerVolume = 200;

Target box(const dvec3& place, Random& random) {
  const double size = std::exp2(random.uniform(-6, 6));
  const dvec3 low = place + 10.0 * random.in_cube(), extent = size * (random.in_cube(0.5) + 0.51);
  Aabb aabb;
  aabb.grow(glm::vec3(low));
  aabb.grow(glm::vec3(low + extent));
  Target target{std::vector<float>(6), {}, {}, size, low};
  AabbVolume{}.write(aabb, target.data.data());
  for (int a = 0; a < 3; ++a) {
    Slab slab{{}, {}, aabb.min[a], aabb.max[a]};
    slab.normal[a] = 1;
    target.slabs.push_back(slab);
  }
  return target;
}

Target oriented_box(const dvec3& place, Random& random) {
  const double size = std::exp2(random.uniform(-6, 6));
  Obb obb;
  obb.center = glm::vec3(place + 10.0 * random.in_cube());
  obb.half = glm::vec3(size * (random.in_cube(0.5) + 0.51));
  const dvec3 x = random.direction(), y = glm::normalize(glm::cross(x, random.direction()));
  obb.axis = {glm::vec3(x), glm::vec3(y), glm::vec3(glm::cross(x, y))};
  Target target{std::vector<float>(16), {}, {}, size, dvec3(obb.center)};
  ObbVolume{}.write(obb, target.data.data());
  for (std::size_t i = 0; i < 3; ++i) {
    Slab slab{{}, {}, -obb.half[static_cast<glm::length_t>(i)], obb.half[static_cast<glm::length_t>(i)]};
    set(slab.normal, dvec3(obb.axis[i]));
    set(slab.origin, dvec3(obb.center));
    target.slabs.push_back(slab);
  }
  return target;
}

Target bounding_slabs(const dvec3& place, Random& random) {
  const double size = std::exp2(random.uniform(-6, 6));
  const dvec3 at = place + 10.0 * random.in_cube();
  Scene scene;
  for (int k = 0; k < 3; ++k) scene.add_triangle(at + size * random.in_cube(), at + size * random.in_cube(), at + size * random.in_cube());
  scene.add_sphere(place, 12);
  scene.finish();
  constexpr std::array kSizes{6, 8, 14, 26};
  const KdopVolume volume(scene, kSizes[random.below(kSizes.size())]);
  const std::array prims{scene.prim(0), scene.prim(1), scene.prim(2)};
  const Kdop kdop = volume.fit(scene, prims);
  Target target{std::vector<float>(static_cast<std::size_t>(volume.floats())), {}, volume.shared({}), size, at};
  volume.write(kdop, target.data.data());
  for (std::size_t i = 0; i < volume.directions().size(); ++i) {
    Slab slab{{}, {}, kdop.min[i], kdop.max[i]};
    set(slab.normal, dvec3(volume.directions()[i]));
    set(slab.origin, dvec3(volume.origin()));
    target.slabs.push_back(slab);
  }
  return target;
}

/// A point where planes of two slabs cross, inside a third: of an edge, perhaps of one that other slabs cut off.
dvec3 edge_point(const Target& target, Random& random) {
  for (;;) {
    const std::size_t n = target.slabs.size(), i = random.below(n), j = (i + 1 + random.below(n - 1)) % n, k = random.below(n);
    if (k == i || k == j) continue;
    glm::dmat3 rows(0.0);
    dvec3 height(0.0);
    glm::length_t row = 0;
    for (const std::size_t s : {i, j, k}) {
      const Slab& slab = target.slabs[s];
      const dvec3 normal(slab.normal[0], slab.normal[1], slab.normal[2]), origin(slab.origin[0], slab.origin[1], slab.origin[2]);
      const double share = s == k ? random.uniform() : static_cast<double>(random.below(2));
      for (glm::length_t a = 0; a < 3; ++a) rows[a][row] = normal[a];
      height[row++] = glm::dot(normal, origin) + double{slab.low} + share * (double{slab.high} - double{slab.low});
    }
    if (std::abs(glm::determinant(rows)) > 1e-3) return glm::inverse(rows) * height;
  }
}

Ray aimed(const dvec3& at, double size, Random& random) {
  const dvec3 org(glm::vec3(at + size * std::pow(10.0, random.uniform(-1, 3)) * random.direction()));
  dvec3 dir = at - org;
  if (dir != dvec3(0)) dir = glm::normalize(dir);
  if (random.below(4) == 0) dir[static_cast<glm::length_t>(random.below(3))] = random.below(2) == 0 ? 0.0 : -0.0;  // along planes
  if (dir == dvec3(0)) dir.x = 1;
  const auto axis = static_cast<glm::length_t>(random.below(3));
  if (random.below(4) == 0 && std::abs(dir[axis]) < 0.9 * glm::length(dir)) dir[axis] *= std::exp2(-random.uniform(10, 140));  // all but along planes
  return test::make_ray(org, dir);
}

const std::array kPlaces{dvec3(0.0), 1e5 * dvec3(1, 1.3, 1.6)};

template <class Make>
void expect_no_false_misses(Make make, VolumeKernel Kernels::*kernel) {
  Random random(10);
  for (const dvec3& place : kPlaces) {
    SCOPED_TRACE(place.x);
    Count count;
    while (count.rays < kRays) {
      const Target target = make(place, random);
      RayBatch rays;
      for (int k = 0; k < kRaysPerVolume; ++k) {
        const Ray ray = aimed(edge_point(target, random), target.size, random);
        if (test::truly_meets(ray, target.slabs)) rays.push_back(ray);
      }
      trace(target, rays, kernel, count);
    }
    test::expect_all_met(count, kRays);
  }
}

TEST(VolumeKernels, BoxesMissNoRay) { expect_no_false_misses(box, &Kernels::boxes); }
TEST(VolumeKernels, OrientedBoxesMissNoRay) { expect_no_false_misses(oriented_box, &Kernels::oriented); }
TEST(VolumeKernels, SlabsMissNoRay) { expect_no_false_misses(bounding_slabs, &Kernels::slabs); }

TEST(VolumeKernels, SpheresMissNoRay) {
  Random random(11);
  for (const dvec3& place : kPlaces) {
    SCOPED_TRACE(place.x);
    Count count;
    while (count.rays < kRays) {
      const double size = std::exp2(random.uniform(-6, 6));
      const BoundingSphere sphere{glm::vec3(place + 10.0 * random.in_cube()), static_cast<float>(size)};
      Target target{std::vector<float>(4), {}, {}, size, dvec3(sphere.center)};
      SphereVolume{}.write(sphere, target.data.data());
      RayBatch rays;
      for (int k = 0; k < kRaysPerVolume; ++k) {
        const dvec3 away = random.direction(), across = glm::normalize(glm::cross(away, random.direction()));
        const Ray ray = aimed(dvec3(sphere.center) + size * across, size, random);
        float center[3];
        set(center, dvec3(sphere.center));
        if (test::truly_meets_ball(ray, center, sphere.radius)) rays.push_back(ray);
      }
      trace(target, rays, &Kernels::spheres, count);
    }
    test::expect_all_met(count, kRays);
  }
}

/// The boxes of wide nodes, as they are tested by each traversal: beams, streams and single rays, and streams of quantised nodes. Among a few boxes of
/// triangles they lose no hit that the list finds, at least a million in each place, and find no other.
TEST(VolumeKernels, WideNodesMissNoRay) {
  constexpr int kBoxes = 12, kRaysPerScene = 20'000;
  Random random(14);
  const auto traced = [](const Scene& scene, const RayBatch& rays, std::string_view technique, Isa isa) {
    const TechniqueSpec spec = parse_technique(technique);
    HitBatch hits;
    trace_closest(*spec.structure->build(scene, spec.params, 1)->intersector({isa, kMaxPacket, spec.params}), rays, hits, 1);
    return hits;
  };
  for (const dvec3& place : kPlaces) {
    SCOPED_TRACE(place.x);
    for (std::int64_t met = 0; met < kRays;) {
      Scene scene;
      std::vector<Target> boxes;
      for (int k = 0; k < kBoxes; ++k) {
        const std::vector<float>& planes = boxes.emplace_back(box(place, random)).data;
        cases::add_box(scene, {planes[0], planes[1], planes[2]}, {planes[3], planes[4], planes[5]});
      }
      scene.finish();
      RayBatch rays;
      for (int k = 0; k < kRaysPerScene; ++k) {
        const Target& target = boxes[random.below(boxes.size())];
        rays.push_back(aimed(edge_point(target, random), target.size, random));
      }
      std::int64_t least = kRaysPerScene;
      for (const Isa isa : kIsas) {
        if (!available(isa)) continue;
        const HitBatch expected = traced(scene, rays, "list", isa);
        least = std::min<std::int64_t>(least, std::ranges::count_if(expected.prim.span(), [](std::int32_t prim) { return prim >= 0; }));
        for (const char* technique : {"bvh:traversal=beam", "bvh:traversal=stream", "bvh:traversal=single", "bvh:traversal=stream,plane_bits=8"}) {
          ASSERT_TRUE(bits_equal(traced(scene, rays, technique, isa), expected)) << technique << ' ' << name(isa);
        }
      }
      met += least;
    }
  }
}

/// Origins of any magnitude, directions along an axis and others all but 0: what a plane times a reciprocal may not overflow on.
TEST(VolumeKernels, BoxesMissNoRayFromAnywhere) {
  Random random(13);
  Count count;
  for (int volume = 0; volume < 5000; ++volume) {
    const Target target = box(random.below(2) == 0 ? dvec3(0) : kPlaces[1], random);
    RayBatch rays;
    for (int k = 0; k < 40; ++k) {
      dvec3 org = edge_point(target, random), dir(0);
      const auto axis = static_cast<glm::length_t>(random.below(3));
      dir[axis] = random.below(2) == 0 ? 1 : -1;
      org[axis] -= dir[axis] * std::exp2(random.uniform(-20, 126));
      for (glm::length_t a = 0; a < 3; ++a) {
        if (a != axis && random.below(2) == 0) dir[a] = (random.below(2) == 0 ? 1 : -1) * std::exp2(-random.uniform(30, 150));
      }
      const Ray ray = test::make_ray(org, dir);
      if (test::truly_meets(ray, target.slabs)) rays.push_back(ray);
    }
    trace(target, rays, &Kernels::boxes, count);
  }
  test::expect_all_met(count, 20'000);
}

TEST(VolumeKernels, EmptyAndInvertedBoxesAreMissed) {
  const float inf = std::numeric_limits<float>::infinity();
  const std::array<float, 6> empty{inf, inf, inf, -inf, -inf, -inf};
  Random random(12);
  RayBatch rays;
  for (int k = 0; k < 1000; ++k) rays.push_back(aimed(random.in_cube(), 1, random));
  for (int k = 0; k < 8; ++k) rays.push_back(Ray{{0, 0, 0}, 0, {k & 1 ? 0.0f : -0.0f, k & 2 ? 1.0f : 0.0f, k & 4 ? 1.0f : -1.0f}, inf});
  for (const Kernels& kernels : kKernels) {
    if (!available(kernels.isa)) continue;
    EXPECT_EQ(kernels.boxes({{}, empty.data(), 6, {}, 1}, rays.view()).hits, 0) << name(kernels.isa);
  }
}

}  // namespace
}  // namespace raymeter
