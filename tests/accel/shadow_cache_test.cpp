// The shadow cache: that it changes no answer, what it counts, and what is published of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <numeric>
#include <span>

#include "accel/registry.h"
#include "core/base/error.h"
#include "core/ray/generators.h"
#include "core/render/whitted.h"
#include "experiments/cases/hard_case.h"
#include "experiments/scenes/scene_source.h"
#include "tests/support/random.h"
#include "tests/support/shadows.h"
#include "tests/support/test_rays.h"
#include "tests/support/traces.h"

namespace raymeter {
namespace {

using test::Blockers;
using test::cache_of;
using test::find;
using test::Shadow;

constexpr std::array kVariants{
    "key=light_object,batch=257",
    "key=light,update=serial",
    "key=light_object,update=serial",
    "key=light_tree,update=serial",
    "key=light,update=serial,forget=true",
    "key=light,batch=1",
    "key=light_object,batch=7",
    "key=light_object,batch=1025",
    "key=light_tree,batch=100",
    "key=light_object",
    "key=light,forget=true",
};

/// An intersector that can be made to say that one primitive blocks every ray.
class Liar final : public Intersector {
public:
  explicit Liar(Intersector& honest) : honest_(honest) {}
  std::int32_t lie = -1;
  [[nodiscard]] bool keeps_batch() const noexcept override { return honest_.keeps_batch(); }
  void prepare(const RayView& rays, Query query, int threads) override { honest_.prepare(rays, query, threads); }
  [[nodiscard]] const std::int32_t* order() const noexcept override { return lie < 0 ? honest_.order() : nullptr; }
  [[nodiscard]] std::size_t scratch_bytes() const noexcept override { return honest_.scratch_bytes(); }
  void closest_hit(const RayView& rays, const HitView& hits, Counters* counters, std::byte* scratch) const noexcept override {
    honest_.closest_hit(rays, hits, counters, scratch);
  }
  void any_hit(const RayView& rays, std::int32_t* blocker, Counters* counters, std::byte* scratch) const noexcept override {
    if (lie < 0) return honest_.any_hit(rays, blocker, counters, scratch);
    std::fill_n(blocker, rays.count, lie);
  }

private:
  Intersector& honest_;
};

constexpr int kLights = 3;

/// The rays in random order, from random primitives to random lights.
Shadow shadow_of(const RayBatch& rays, const Scene& scene, std::size_t count) {
  test::Random random(11);
  std::vector<std::size_t> order(rays.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  Shadow shadow;
  for (std::size_t k = 0; k < std::min(count, order.size()); ++k) {
    shadow.rays.push_back(rays[order[k]]);
    shadow.origins.push_back(static_cast<std::int32_t>(random.below(kLights)),
                             static_cast<std::int32_t>(random.below(static_cast<std::size_t>(scene.prim_id_count()))));
  }
  return shadow;
}

/// The hard scenes that rays can start from, with lights.
std::vector<Scene> lit_scenes() {
  std::vector<Scene> lit;
  for (const Scene& scene : test::scenes()) {
    if (scene.prim_count() == 0) continue;
    lit.push_back(scene);
    lit.back().lights.assign(kLights, Light{});
  }
  return lit;
}

void expect_same_booleans(const Blockers& blockers, const Blockers& expected) {
  ASSERT_EQ(blockers.size(), expected.size());
  for (std::size_t i = 0; i < blockers.size(); ++i) ASSERT_EQ(blockers[i] >= 0, expected[i] >= 0) << "ray " << i;
}

class ShadowCache : public testing::TestWithParam<Isa> {
protected:
  void SetUp() override {
    if (!available(GetParam())) GTEST_SKIP() << name(GetParam()) << " is not available on this machine";
  }
};

TEST_P(ShadowCache, BlocksTheSameRaysInFrontOfEveryStructure) {
  const Isa isa = GetParam();
  for (const Scene& scene : lit_scenes()) {
    const Shadow shadow = shadow_of(test::reference_rays(scene, isa), scene, 1500);
    const Blockers expected = test::trace_list(scene, isa, shadow.rays).blockers;
    for (const StructureEntry& entry : structures()) {
      const ParamValues params = entry.resolve({});
      const auto structure = entry.build(scene, params, 1);
      const bool tried_with_all = entry.name == "list" || entry.name == "bvh";
      const std::span<const char* const> variants(kVariants.data(), tried_with_all ? kVariants.size() : 2);
      for (const char* variant : variants) {
        for (const int packet : {1, 3, kMaxPacket}) {
          SCOPED_TRACE(scene.name + " " + std::string(entry.name) + " " + variant + " packet " + std::to_string(packet));
          const auto intersector = structure->intersector({isa, packet, params});
          const auto cache = cache_of(scene, variant, {isa, packet, 1, {}}, *intersector);
          Blockers counted, timed;
          const Counters counters = find(*cache, shadow, 1, counted);
          cache->begin();
          cache->find(shadow.rays, shadow.origins, timed, 1, nullptr);
          expect_same_booleans(counted, expected);
          EXPECT_TRUE(std::ranges::equal(counted.span(), timed.span())) << "timed and counting kernels differ";
          EXPECT_EQ(counters.ray_count, shadow.rays.size());
          EXPECT_LE(counters.live(Event::cache_hit), counters.live(Event::cache_test));
          if (HasFailure()) return;
        }
      }
    }
  }
}

TEST_P(ShadowCache, BlocksTheSameRaysInHardCases) {
  const Isa isa = GetParam();
  for (const HardCase& hard : hard_cases()) {
    Problem problem = hard.make(300, 1);
    if (problem.scene.prim_count() == 0) continue;
    problem.scene.lights.assign(kLights, Light{});
    const Shadow shadow = shadow_of(problem.set.rays, problem.scene, problem.set.rays.size());
    const StructureEntry& bvh = structure_entry("bvh");
    const ParamValues params = bvh.resolve({});
    const auto structure = bvh.build(problem.scene, params, 1);
    const auto intersector = structure->intersector({isa, 16, params});
    Blockers expected;
    trace_any(*intersector, shadow.rays, expected, 1);
    for (const char* variant : {"key=light_object,batch=7", "key=light,update=serial", "key=light_tree,batch=100"}) {
      SCOPED_TRACE(std::string(hard.name) + " " + variant);
      Blockers blockers;
      (void)find(*cache_of(problem.scene, variant, {isa, 16, 1, {}}, *intersector), shadow, 1, blockers);
      expect_same_booleans(blockers, expected);
      if (HasFailure()) return;
    }
  }
}

TEST_P(ShadowCache, IsNotFooledByAnyPrimitive) {
  const Isa isa = GetParam();
  for (const Scene& scene : lit_scenes()) {
    if (scene.prim_id_count() > 250) continue;  // for time's sake
    const ParamValues params = structure_entry("bvh").resolve({});
    const auto structure = structure_entry("bvh").build(scene, params, 1);
    const auto honest = structure->intersector({isa, 16, params});
    Liar liar(*honest);
    const Shadow shadow = shadow_of(test::hard_rays(scene, 7), scene, 400);
    const Blockers expected = test::trace_list(scene, isa, shadow.rays).blockers;
    for (const char* variant : {"key=light,update=serial", "key=light_object,batch=64"}) {
      const auto cache = cache_of(scene, variant, {isa, 16, 1, {}}, liar);
      for (std::int32_t prim = 0; prim < scene.prim_id_count(); ++prim) {
        SCOPED_TRACE(scene.name + " " + variant + " primitive " + std::to_string(prim));
        Blockers blockers;
        cache->begin();
        liar.lie = prim;
        find(*cache, shadow, 1, blockers);
        liar.lie = -1;
        const Counters counters = find(*cache, shadow, 1, blockers);
        expect_same_booleans(blockers, expected);
        EXPECT_TRUE(scene.prim(prim).dropped() || counters.live(Event::cache_test) > 0);
        if (HasFailure()) return;
      }
    }
  }
}

TEST_P(ShadowCache, CountsDoNotDependOnThreads) {
  const Isa isa = GetParam();
  Scene scene = test::scene_named("mixed");
  scene.lights.assign(kLights, Light{});
  const RayBatch once = test::reference_rays(scene, isa);
  RayBatch rays;
  for (int repeat = 0; repeat < 4; ++repeat) rays.append(once);
  const Shadow shadow = shadow_of(rays, scene, rays.size());
  const ParamValues params = structure_entry("bvh").resolve({});
  const auto structure = structure_entry("bvh").build(scene, params, 1);
  const auto intersector = structure->intersector({isa, 16, params});
  for (const char* variant : {"key=light_object,batch=10000", "key=light,batch=3000", "key=light_object,update=serial"}) {
    const auto cache = cache_of(scene, variant, {isa, 16, 1, {}}, *intersector);
    Blockers one;
    const Counters expected = find(*cache, shadow, 1, one);
    EXPECT_GT(expected.live(Event::cache_hit), 0u) << variant;
    for (const int threads : {2, 7}) {
      SCOPED_TRACE(std::string(variant) + " threads " + std::to_string(threads));
      Blockers many;
      cache->begin();
      EXPECT_EQ(find(*cache, shadow, threads, many), expected);
      EXPECT_TRUE(std::ranges::equal(many.span(), one.span()));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(EveryIsa, ShadowCache, testing::ValuesIn(kIsas), [](const auto& tested) { return std::string(name(tested.param)); });

TEST(ShadowCacheParameters, SayWhatIsWrong) {
  const auto message = [](const char* technique) -> std::string {
    try {
      (void)parse_technique(technique);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(message("bvh+shadow_cache:key=lamp"), "shadow_cache:key: expected one of light, light_object, light_tree, got 'lamp'");
  EXPECT_EQ(message("bvh+shadow_cache:update=serial,batch=2"),
            "shadow_cache:batch: does nothing beside the other parameters, expected its default, 512, got 2 (rays of a batch, in images within a tile of 4096 "
            "pixels: fewer learn sooner, more share packets and threads)");
  EXPECT_EQ(message("bvh+shadow_cache:batch=0"), "shadow_cache:batch: expected a whole number from 1 to 1048576, got 0");
}

TEST(RayTreeNumbers, AreThoseOfAHeapDownToTheLastLevel) {
  EXPECT_EQ(RayTree::reflection(RayTree::kEye), 2);
  EXPECT_EQ(RayTree::refraction(RayTree::kEye), 3);
  EXPECT_EQ(RayTree::refraction(RayTree::reflection(3)), 13);
  std::int32_t node = RayTree::kEye;
  for (int depth = 0; depth < 100; ++depth) {
    node = RayTree::refraction(node);
    ASSERT_LT(node, RayTree::kNodes);
  }
  EXPECT_EQ(node, RayTree::kNodes - 1);
}

TEST(ShadowCacheOfFrames, ChangesNoPixelAndNoCount) {
  for (const char* spec : {"spd:balls:2", "spd:gears:1", "spd:mount:3"}) {
    const Scene scene = load_scene(spec);
    const ParamValues params = structure_entry("bvh").resolve({});
    const auto structure = structure_entry("bvh").build(scene, params, 1);
    const auto intersector = structure->intersector({best_isa(), 16, params});
    CastFirstHit cast(*intersector);
    RenderOptions options{{scene.camera, CameraConvention::pixel, 96, 96}, {}, 1, true};
    const Rendering plain = render(scene, cast, *intersector, options);
    for (const char* variant : {"key=light,update=serial", "key=light_tree,update=serial", "key=light_object,batch=256"}) {
      SCOPED_TRACE(std::string(spec) + " " + variant);
      const auto cache = cache_of(scene, variant, {best_isa(), 16, 1, {}}, *intersector);
      options.occlusion = cache.get();
      options.threads = 1;
      const Rendering one = render(scene, cast, *intersector, options);
      options.threads = 2;
      const Rendering two = render(scene, cast, *intersector, options);
      for (const Rendering* cached : {&one, &two}) {
        EXPECT_EQ(cached->rays, plain.rays);
        EXPECT_EQ(std::memcmp(cached->image.pixel.data(), plain.image.pixel.data(), plain.image.pixel.size() * sizeof(glm::vec3)), 0);
      }
      const Counters& counters = one.totals[FramePhase::shadow].counters;
      EXPECT_GT(counters.live(Event::cache_hit), 0u);
      EXPECT_EQ(counters, two.totals[FramePhase::shadow].counters);
      EXPECT_EQ(counters.ray_count, plain.totals[FramePhase::shadow].counters.ray_count);
    }
  }
}

/// Readme of the SPD, 513 x 513 eye rays: of 46111 shadow rays of tetra the cache of Haines' program answered 3407. It kept one blocker for each light and node
/// of the ray tree (tetra's is the eye ray alone), also when a ray was free; pixels came in scanlines, and blockers in the order in which his hierarchy, of
/// Goldsmith and Salmon, finds them.
TEST(ShadowCachePublished, TetraIsAnsweredAsHainesPrinted) {
#ifndef __OPTIMIZE__
  GTEST_SKIP() << "millions of tests: optimised builds only";
#endif
  const Scene scene = load_scene("spd:tetra:6");
  const TechniqueSpec spec = parse_technique("bvh:builder=goldsmith_salmon,traversal=heap");
  const auto structure = spec.structure->build(scene, spec.params, 0);
  const auto intersector = structure->intersector({Isa::scalar, 1, spec.params});
  const RaySet set = make_rays(scene, RayKind::shadow, {scene.camera, CameraConvention::spd, 513, 513}, 1, *intersector, 0);
  std::vector<std::size_t> scanlines(set.rays.size());
  std::iota(scanlines.begin(), scanlines.end(), std::size_t{0});
  std::ranges::sort(scanlines, {}, [&](std::size_t i) { return set.pixel[i]; });
  Shadow shadow;
  for (const std::size_t i : scanlines) {
    shadow.rays.push_back(set.rays[i]);
    shadow.origins.push_back(set.origins.light[i], set.origins.source[i]);
  }
  for (const char* variant : {"key=light,update=serial", "key=light_tree,update=serial"}) {
    Blockers blockers;
    const Counters counters = find(*cache_of(scene, variant, {}, *intersector), shadow, 1, blockers);
    EXPECT_NEAR(static_cast<double>(counters.ray_count), 46111, 0.002 * 46111);
    EXPECT_NEAR(static_cast<double>(counters.live(Event::cache_hit)), 3407, 0.05 * 3407) << variant;
    RecordProperty(variant, static_cast<int>(counters.live(Event::cache_hit)));
  }
}

}  // namespace
}  // namespace raymeter
