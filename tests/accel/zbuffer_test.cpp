// The first hits of eye rays from footprints on the image: the exact modes, against casting.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include <glm/geometric.hpp>

#include "core/bounds/aabb.h"
#include "core/ray/generators.h"
#include "core/render/whitted.h"
#include "experiments/cases/hard_case.h"
#include "experiments/scenes/scene_source.h"
#include "tests/support/first_hits.h"
#include "tests/support/random.h"
#include "tests/support/traces.h"

namespace raymeter {
namespace {

using test::pixels_of;
using test::Random;
using test::slanted_model;
using test::Slots;
using test::subsample_scene;

struct View {
  std::string name;
  CameraModel model;
};

/// Cameras before, in, beside and far from a scene, looking at it, past it and away, with narrow and wide fields of view; all conventions; odd sizes.
std::vector<View> views_of(const Scene& scene) {
  Aabb box;
  for (std::int32_t prim = 0; prim < scene.prim_id_count(); ++prim) {
    if (!scene.prim(prim).dropped()) box.grow(tight_bounds(scene.pools(), scene.prim(prim)));
  }
  if (box.empty()) box.grow(glm::vec3(0.0f));
  const glm::dvec3 center = (glm::dvec3(box.min) + glm::dvec3(box.max)) / 2.0;
  const double size = std::max(1e-30, glm::length(glm::dvec3(box.max) - glm::dvec3(box.min)));
  const glm::dvec3 before = center + size * glm::dvec3(0.3, 0.5, 1.0), corner(box.max);
  const auto camera = [&](glm::dvec3 eye, glm::dvec3 at, double fov) { return Camera{eye, at, {0, 1, 0}, fov, 0, 0, 0}; };
  using enum CameraConvention;
  return {{"before", {camera(before, center, 45), pixel, 61, 43}},
          {"inside", {camera(center + 0.01 * size, corner, 70), spd, 48, 33}},
          {"in the middle, wide", {camera(center, center + glm::dvec3(1, 0.1, 0), 140), havran, 35, 35}},
          {"wider than footprints go", {camera(before, center, 176), pixel, 32, 32}},
          {"grazing", {camera(glm::dvec3(box.min) - glm::dvec3(size, 0, 0.001 * size), center, 30), pixel, 33, 65}},
          {"far", {camera(center + 1e3 * size * glm::dvec3(0.6, 0.48, 0.64), center, 0.06), spd, 40, 40}},
          {"away", {camera(before, before + (before - center), 60), pixel, 17, 17}},
          {"at a corner", {camera(corner, center, 60), havran, 31, 31}}};
}

class ZbufferExact : public testing::TestWithParam<Isa> {
protected:
  void SetUp() override {
    if (!available(GetParam())) GTEST_SKIP() << name(GetParam()) << " is not available on this machine";
  }
  /// Expects the exact modes to find what casting finds.
  void expect_exact(const Scene& scene, const CameraModel& model, const std::vector<std::string>& modes, const std::vector<int>& packets) {
    const Column<std::int32_t> pixels = pixels_of(model);
    RayBatch rays;
    eye_rays(model, pixels, rays);
    const HitBatch expected = Slots(scene, "bvh", GetParam(), 16).find(model, pixels);
    for (const int packet : packets) {
      for (const std::string& mode : modes) {
        SCOPED_TRACE(mode + ", packets of " + std::to_string(packet));
        test::expect_same_hits(Slots(scene, "bvh+zbuffer:mode=" + mode, GetParam(), packet).find(model, pixels), expected, rays);
      }
    }
  }
};

TEST_P(ZbufferExact, FindsWhatCastingFindsInHardScenesFromAllSides) {
  std::size_t round = 0;
  for (const Scene& scene : test::scenes()) {
    for (const View& view : views_of(scene)) {
      SCOPED_TRACE(scene.name + ", " + view.name);
      constexpr std::array packets{1, 3, 16, 64};
      expect_exact(scene, view.model, {"list", "seed"}, {packets[round++ % packets.size()], 16});
    }
  }
}

TEST_P(ZbufferExact, FindsWhatCastingFindsInHardCases) {
  std::size_t round = 0;
  for (const HardCase& hard : hard_cases()) {
    const Scene scene = hard.make(1, 1).scene;
    if (scene.prim_id_count() > 20'000) continue;  // many coincident ones, which have a test of their own
    for (const View& view : views_of(scene)) {
      if (round++ % 3 != 0) continue;  // of each case two views or three, in turn
      SCOPED_TRACE(std::string(hard.name) + ", " + view.name);
      expect_exact(scene, view.model, {"list", "seed"}, {round % 2 == 0 ? 3 : 16});
    }
  }
}

TEST_P(ZbufferExact, FindsHairsThinnerThanASample) {
  const Scene scene = load_scene("gen:hairball:20");
  CameraModel model{scene.camera, CameraConvention::pixel, 120, 90};
  expect_exact(scene, model, {"list", "seed", "seed,resolution=2"}, {16, 64});
  model.camera.eye = model.camera.look_at;  // among the hairs
  model.camera.look_at += glm::dvec3(0.3, -0.2, 0.9);
  expect_exact(scene, model, {"list", "seed"}, {16});
}

TEST_P(ZbufferExact, FindsWhatIsSmallerThanASampleOrEndsAtOne) {
  for (const CameraConvention convention : kCameraConventions) {
    const CameraModel model = slanted_model(convention);
    expect_exact(subsample_scene(model), model, {"list", "seed"}, {1, 16, 64});
  }
}

TEST_P(ZbufferExact, FindsWhatPassesThroughThePlaneOfTheEye) {
  Scene scene;
  Random random(49);
  for (int i = 0; i < 300; ++i) {
    const glm::dvec3 p = std::pow(10.0, random.uniform(-5, 2)) * random.direction();
    const glm::dvec3 e = random.uniform(0, 3) * random.direction() - (i % 3 == 0 ? 1.0 : 0.0) * p, f = random.uniform(0, 3) * random.direction();
    switch (i % 4) {
      case 0: scene.add_triangle(p, p + e, p + f); break;
      case 1: scene.add_sphere(p, 0.3 * glm::length(p) * random.uniform(0.5, 4)); break;
      case 2: scene.add_cone(p, 0.1, p + e, 0.05); break;
      default: scene.add_polygon(std::array{p, p + e, p + e + f, p + f});
    }
  }
  scene.add_triangle({0, 0, 0}, {1, 0, 1}, {0, 1, 1});     // the eye is its vertex
  scene.add_triangle({-1, 0, -5}, {1, 0, -5}, {0, 0, 5});  // the eye is in its plane
  scene.finish();
  for (const double fov : {40.0, 120.0, 170.0}) {
    for (const glm::dvec3& at : {glm::dvec3(0, 0, 1), glm::dvec3(1, 0, 0), glm::dvec3(-1, -2, -1)}) {
      expect_exact(scene, {{{0, 0, 0}, at, {0, 1, 0.1}, fov, 0, 0, 0}, CameraConvention::pixel, 40, 32}, {"list", "seed"}, {16});
    }
  }
}

TEST_P(ZbufferExact, TakesRaysInAnyOrderAndBandsOfAnySize) {
  const Scene& scene = test::scene_named("mixed");
  const CameraModel model = views_of(scene).front().model;
  const Column<std::int32_t> ordered = pixels_of(model);
  const HitBatch all = Slots(scene, "bvh", GetParam(), 16).find(model, ordered);
  std::vector<std::size_t> shuffled(ordered.size());
  for (std::size_t i = 0; i < shuffled.size(); ++i) shuffled[i] = i;
  Random random(7);
  for (std::size_t i = shuffled.size(); i > 1; --i) std::swap(shuffled[i - 1], shuffled[random.below(i)]);
  for (const std::size_t size : {std::size_t{1}, std::size_t{257}, shuffled.size()}) {
    Column<std::int32_t> pixels;
    for (std::size_t i = 0; i < size; ++i) pixels.push_back(ordered[shuffled[i]]);
    for (const char* mode : {"list", "seed"}) {
      const HitBatch hits = Slots(scene, std::string("bvh+zbuffer:mode=") + mode, GetParam(), 16).find(model, pixels);
      for (std::size_t i = 0; i < size; ++i) {
        ASSERT_EQ(hits.prim[i], all.prim[shuffled[i]]) << mode << ", ray " << i;
        ASSERT_EQ(hits.t[i], all.t[shuffled[i]]) << mode << ", ray " << i;
      }
    }
  }
}

TEST_P(ZbufferExact, HitsAndCountsDoNotDependOnThreads) {
  const Scene scene = load_scene("spd:mount:2");
  const CameraModel model{scene.camera, CameraConvention::spd, 113, 97};
  const Column<std::int32_t> pixels = pixels_of(model);
  for (const char* mode : {"list", "seed", "final", "final,resolution=2"}) {
    SCOPED_TRACE(mode);
    Slots slots(scene, std::string("bvh+zbuffer:mode=") + mode, GetParam(), 16);
    Counters one;
    const HitBatch expected = slots.find(model, pixels, 1, &one);
    EXPECT_GT(one.live(Event::volume_test), 0u);
    EXPECT_GE(one.live(Event::prim_test), one.live(Event::prim_hit));
    EXPECT_EQ(one.ray_count, pixels.size());
    for (const int threads : {2, 7}) {
      Counters counters;
      EXPECT_TRUE(bits_equal(slots.find(model, pixels, threads, &counters), expected)) << threads << " threads";
      EXPECT_EQ(counters, one) << threads << " threads";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(AllIsas, ZbufferExact, testing::ValuesIn(kIsas), [](const auto& instance) { return std::string(name(instance.param)); });

TEST(Zbuffer, ImagesAndRayCountsAreThoseOfCasting) {
  const Scene scene = load_scene("spd:balls:2");
  const auto rendered = [&](const char* text) {
    Slots slots(scene, text, best_isa(), 16);
    RenderOptions options;
    options.model = {scene.camera, CameraConvention::spd, 90, 90};
    options.threads = 2;
    return render(scene, *slots.first_hit, *slots.intersector, options);
  };
  const Rendering cast = rendered("bvh");
  for (const char* text : {"grid+zbuffer", "bvh+zbuffer:mode=seed", "bvh:traversal=beam+zbuffer:mode=seed"}) {
    const Rendering hybrid = rendered(text);
    EXPECT_EQ(hybrid.rays, cast.rays) << text;
    EXPECT_TRUE(std::ranges::equal(hybrid.image.pixel.span(), cast.image.pixel.span())) << text;
  }
}

TEST(Zbuffer, ManyCoincidentPrimitivesAcrossTheImageTakeLittleMemory) {
  Scene scene;
  for (int i = 0; i < 20000; ++i) scene.add_triangle({-5, -5, 0}, {5, -5, 0}, {0, 9, 0});
  scene.finish();
  const CameraModel model{{{0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 45, 0, 0, 0}, CameraConvention::pixel, 32, 32};
  const HitBatch hits = Slots(scene, "bvh+zbuffer", best_isa(), 16).find(model, pixels_of(model));
  EXPECT_TRUE(std::all_of(hits.prim.begin(), hits.prim.end(), [](std::int32_t prim) { return prim == 0; })) << "ties go to the smallest id";
}

}  // namespace
}  // namespace raymeter
