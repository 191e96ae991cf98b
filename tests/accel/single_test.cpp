#include <gtest/gtest.h>

#include "accel/registry.h"
#include "tests/support/test_rays.h"
#include "tests/support/test_scenes.h"
#include "tests/support/traces.h"

namespace raymeter {
namespace {

using test::scene_named;
using test::Traced;

const TechniqueSpec& single() {
  static const TechniqueSpec spec = parse_technique("bvh:traversal=single");
  return spec;
}

Traced trace_with(const Structure& structure, const TechniqueSpec& spec, Isa isa, int packet, const RayBatch& rays, int threads = 1) {
  return test::trace(structure, {isa, packet, spec.params}, rays, threads);
}

TEST(Single, TakesBatchesOfAnySizeAndNoNoticeOfPackets) {
  const Scene& scene = scene_named("mixed");
  const auto structure = single().structure->build(scene, single().params, 1);
  const RayBatch hard = test::hard_rays(scene, 11);
  for (const Isa isa : kIsas) {
    if (!available(isa)) continue;
    for (std::size_t size = 0; size <= 2 * static_cast<std::size_t>(simd_width(isa)) + 1; ++size) {
      RayBatch rays;
      for (std::size_t i = 0; i < size; ++i) rays.push_back(hard[(7 * size + i) % hard.size()]);
      SCOPED_TRACE(std::string(name(isa)) + " size " + std::to_string(size));
      const HitBatch list = test::trace_list(scene, isa, rays).hits;
      const Traced one = trace_with(*structure, single(), isa, 1, rays);
      test::expect_same_hits(one.hits, list, rays);
      for (std::size_t i = 0; i < size; ++i) ASSERT_EQ(one.blockers[i] >= 0, list.prim[i] >= 0) << i;
      EXPECT_EQ(trace_with(*structure, single(), isa, kMaxPacket, rays).closest, one.closest);
    }
  }
}

TEST(Single, CountsAlikeOnAnyNumberOfThreads) {
  for (const char* scene_name : {"mixed", "icosphere"}) {
    const Scene& scene = scene_named(scene_name);
    const RayBatch hard = test::hard_rays(scene, 3);
    RayBatch rays;
    for (std::size_t i = 0; i < 3000; ++i) rays.push_back(hard[i % hard.size()]);
    const auto structure = single().structure->build(scene, single().params, 1);
    for (const Isa isa : kIsas) {
      if (!available(isa)) continue;
      const Traced one = trace_with(*structure, single(), isa, 1, rays);
      for (const int threads : {2, 7}) {
        const Traced many = trace_with(*structure, single(), isa, 1, rays, threads);
        EXPECT_EQ(many.closest, one.closest) << scene_name << ' ' << name(isa);
        EXPECT_EQ(many.any, one.any) << scene_name << ' ' << name(isa);
      }
    }
  }
}

TEST(Single, DropsWhatBeginsBehindTheHit) {
  const Scene& scene = scene_named("icosphere");
  const RayBatch rays = test::coherent_rays(scene);
  const TechniqueSpec stream = parse_technique("bvh:traversal=stream");
  const auto structure = single().structure->build(scene, single().params, 1);
  for (const Isa isa : kIsas) {
    if (!available(isa)) continue;
    const std::uint64_t width = static_cast<std::uint64_t>(simd_width(isa));
    const Traced one = trace_with(*structure, single(), isa, 1, rays), alone = trace_with(*structure, stream, isa, 1, rays);
    for (const Counters& counters : {one.closest, one.any}) {
      EXPECT_EQ(counters.live(Event::volume_test), 8 * counters.live(Event::node_visit));
      EXPECT_EQ(counters.executed(Event::volume_test), (width < 8 ? 8 / width : 1) * counters.live(Event::node_visit));
      EXPECT_EQ(counters.executed(Event::leaf_visit), counters.live(Event::leaf_visit));
      EXPECT_LE(counters.live(Event::prim_hit), counters.live(Event::prim_test));
    }
    EXPECT_LT(one.closest.live(Event::prim_test), alone.closest.live(Event::prim_test));
    EXPECT_LE(one.closest.live(Event::node_visit), alone.closest.live(Event::node_visit));
  }
}

}  // namespace
}  // namespace raymeter
