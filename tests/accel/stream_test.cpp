#include <gtest/gtest.h>

#include <set>

#include "accel/registry.h"
#include "core/trace/trace.h"
#include "tests/support/answer.h"
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
      const Traced list = test::trace_list(scene, isa, rays);
      for (const int packet : {1, 7, kMaxPacket}) {
        SCOPED_TRACE(std::string(name(isa)) + " size " + std::to_string(size) + " packet " + std::to_string(packet));
        const Traced found = test::trace(*structure, {isa, packet, stream().params}, rays);
        expect_same_hits(found.hits, list.hits, rays);
        for (std::size_t i = 0; i < size; ++i) ASSERT_EQ(found.blockers[i] >= 0, list.hits.prim[i] >= 0) << i;
      }
    }
  }
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
