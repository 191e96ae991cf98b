#include <gtest/gtest.h>

#include <set>

#include "accel/registry.h"
#include "core/trace/trace.h"
#include "tests/support/answer.h"
#include "tests/support/random.h"
#include "tests/support/test_rays.h"
#include "tests/support/test_scenes.h"
#include "tests/support/traces.h"

namespace raymeter {
namespace {

using test::expect_same_hits;
using test::scene_named;
using test::Traced;

const TechniqueSpec& stream() {
  static const TechniqueSpec spec = parse_technique("bvh:traversal=stream");
  return spec;
}

RayBatch first_of(const RayBatch& rays, std::size_t from, std::size_t count) {
  RayBatch some;
  for (std::size_t i = from; i < from + count; ++i) some.push_back(rays[i % rays.size()]);
  return some;
}

TEST(Stream, TakesBatchesAndGroupsOfAnySize) {
  const Scene& scene = scene_named("mixed");
  const auto structure = stream().structure->build(scene, stream().params, 1);
  const RayBatch hard = test::hard_rays(scene, 11);
  for (const Isa isa : kIsas) {
    if (!available(isa)) continue;
    const std::size_t width = static_cast<std::size_t>(simd_width(isa));
    std::set<std::size_t> sizes{0, 63, 65, 1023, 1024, 1025, 2049};
    for (std::size_t size = 1; size <= 2 * width + 1; ++size) sizes.insert(size);
    for (const std::size_t size : sizes) {
      const RayBatch rays = first_of(hard, 7 * size, size);
      const HitBatch list = test::trace_list(scene, isa, rays).hits;
      for (const int packet : {1, 7, kMaxPacket}) {
        SCOPED_TRACE(std::string(name(isa)) + " size " + std::to_string(size) + " packet " + std::to_string(packet));
        const Traced found = test::trace(*structure, {isa, packet, stream().params}, rays);
        expect_same_hits(found.hits, list, rays);
        for (std::size_t i = 0; i < size; ++i) ASSERT_EQ(found.blockers[i] >= 0, list.prim[i] >= 0) << i;
      }
    }
  }
}

/// Both queries by the list, bit for bit, in groups of one ray up to full ones.
void expect_as_by_list(const Scene& scene, const TechniqueSpec& spec, const RayBatch& rays) {
  const auto structure = spec.structure->build(scene, spec.params, 1);
  for (const Isa isa : kIsas) {
    if (!available(isa)) continue;
    const HitBatch list = test::trace_list(scene, isa, rays).hits;
    for (const int packet : {1, 5, kMaxPacket}) {
      SCOPED_TRACE(std::string(name(isa)) + " packet " + std::to_string(packet));
      const Traced found = test::trace(*structure, {isa, packet, spec.params}, rays);
      expect_same_hits(found.hits, list, rays);
      for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_EQ(found.blockers[i] >= 0, list.prim[i] >= 0) << i;
    }
  }
}

/// Balls in heaps, some of them the same twice, some inside of others, some huge.
Scene heaps_of_spheres(int heaps, int spheres_a_heap) {
  test::Random random(17);
  Scene scene;
  for (int h = 0; h < heaps; ++h) {
    const glm::dvec3 middle = random.in_cube(9);
    for (int i = 0; i < spheres_a_heap; ++i) {
      const glm::dvec3 center = middle + random.in_cube(0.1);
      const double radius = i % 7 == 6 ? 1.5 : random.uniform(0.01, 0.2);
      scene.add_sphere(center, radius);
      if (i % 5 == 4) scene.add_sphere(center, radius);
    }
  }
  scene.finish();
  return scene;
}

TEST(Stream, FindsSpheresOfALeafInLanes) {
  for (const int spheres : {1, 3, 8, 16, 37}) {
    SCOPED_TRACE(std::to_string(spheres) + " spheres a heap");
    const Scene scene = heaps_of_spheres(6, spheres);
    RayBatch rays = test::hard_rays(scene, 23);
    rays.append(test::coherent_rays(scene));
    for (const char* leaf : {"1", "8", "64"}) expect_as_by_list(scene, parse_technique("bvh:traversal=stream,max_leaf_size=" + std::string(leaf)), rays);
  }
}

TEST(Stream, KeepsRaysOfEveryOctantAndLongestAxisApart) {
  const Scene& scene = scene_named("mixed");
  RayBatch lone, many;
  for (const float x : {-2.0f, -1.0f, -0.0f, 0.0f, 1.0f, 2.0f}) {
    for (const float y : {-2.0f, -1.0f, -0.0f, 0.0f, 1.0f, 2.0f}) {
      for (const float z : {-2.0f, -1.0f, -0.0f, 0.0f, 1.0f, 2.0f}) lone.push_back({{0.3f - 3 * x, 0.2f - 3 * y, 0.1f - 3 * z}, 0, {x, y, z}, 1e30f});
    }
  }
  for (std::size_t i = 0; i < 20 * lone.size(); ++i) {
    Ray ray = lone[i % lone.size()];
    ray.org[i % 3] += 0.01f * static_cast<float>(i % 101);
    many.push_back(ray);
  }
  expect_as_by_list(scene, stream(), lone);
  expect_as_by_list(scene, stream(), many);
}

TEST(Stream, CountsAlikeOnAnyNumberOfThreads) {
  for (const char* scene_name : {"mixed", "icosphere"}) {
    const Scene& scene = scene_named(scene_name);
    const RayBatch rays = first_of(test::hard_rays(scene, 3), 0, 9000);
    const auto structure = stream().structure->build(scene, stream().params, 1);
    for (const Isa isa : kIsas) {
      if (!available(isa)) continue;
      const QueryOptions options{isa, kMaxPacket, stream().params};
      const Traced one = test::trace(*structure, options, rays, 1);
      for (const int threads : {2, 7}) {
        const Traced many = test::trace(*structure, options, rays, threads);
        expect_same_hits(many.hits, one.hits, rays);
        EXPECT_EQ(many.closest, one.closest) << scene_name << ' ' << name(isa);
        EXPECT_EQ(many.any, one.any) << scene_name << ' ' << name(isa);
      }
    }
  }
}

TEST(Stream, CountsTheWorkOfEachRayAndFetchesNodesForMany) {
  const Scene& scene = scene_named("icosphere");
  const RayBatch rays = test::coherent_rays(scene);
  const auto structure = stream().structure->build(scene, stream().params, 1);
  for (const Isa isa : kIsas) {
    if (!available(isa)) continue;
    const std::uint64_t width = static_cast<std::uint64_t>(simd_width(isa));
    const Traced alone = test::trace(*structure, {isa, 1, stream().params}, rays), many = test::trace(*structure, {isa, kMaxPacket, stream().params}, rays);
    for (const Counters& counters : {alone.closest, many.closest, alone.any, many.any}) {
      EXPECT_EQ(counters.live(Event::volume_test), 8 * counters.live(Event::node_visit));
      EXPECT_EQ(counters.executed(Event::volume_test), (width < 8 ? 8 / width : 1) * counters.live(Event::node_visit));
      EXPECT_LE(counters.live(Event::prim_hit), counters.live(Event::prim_test));
    }
    // A ray's own work does not depend on who goes with it: order and cull are its own.
    EXPECT_EQ(many.closest.rays[static_cast<std::size_t>(Event::node_visit)], alone.closest.rays[static_cast<std::size_t>(Event::node_visit)]);
    EXPECT_EQ(many.closest.rays[static_cast<std::size_t>(Event::prim_test)], alone.closest.rays[static_cast<std::size_t>(Event::prim_test)]);
    EXPECT_EQ(alone.closest.executed(Event::node_visit), alone.closest.live(Event::node_visit));
    if (width > 1) {
      EXPECT_LT(2 * many.closest.executed(Event::node_visit), many.closest.live(Event::node_visit)) << name(isa);
    }
  }
}

}  // namespace
}  // namespace raymeter
