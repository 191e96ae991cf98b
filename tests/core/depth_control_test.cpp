// Adaptive depth control: what is cut, what that costs, and what is promised of it. Cases 50 and 52 of the numerics' list.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "accel/registry.h"
#include "core/render/radiance_bound.h"
#include "core/render/whitted.h"
#include "experiments/scenes/scene_source.h"

namespace raymeter {
namespace {

Rendering rendered(const Scene& scene, const Termination& termination, int size = 96, int threads = 2) {
  const TechniqueSpec spec = parse_technique("bvh");
  const auto structure = spec.structure->build(scene, spec.params, 1);
  const auto intersector = structure->intersector({best_isa(), 16, spec.params});
  CastFirstHit cast(*intersector);
  RenderOptions options{{scene.camera, CameraConvention::spd, size, size}, termination, threads};
  options.bound = true;
  return render(scene, cast, *intersector, options);
}

bool same_pixels(const Image& a, const Image& b) { return std::memcmp(a.pixel.data(), b.pixel.data(), a.pixel.size() * sizeof(glm::vec3)) == 0; }

class DepthControl : public testing::TestWithParam<const char*> {};

TEST_P(DepthControl, ErrorsRiseWithTheLeastWeightAndStayWithinTheirBound) {
  const Scene scene = load_scene(GetParam());
  const Rendering full = rendered(scene, {6, 0});
  for (const glm::vec3& bound : full.bound) ASSERT_EQ(bound, glm::vec3(0)) << "nothing is cut";
  std::int64_t rays = full.rays.all();
  double mean_depth = full.depth.mean();
  Rendering before = rendered(scene, {6, 0});
  for (const double weight : {1e-6, 1e-4, 1e-3, 1e-2, 0.03, 0.1, 0.3, 1.0, 2.0}) {
    Rendering cut = rendered(scene, {6, weight});
    EXPECT_LE(cut.rays.all(), rays) << weight;
    EXPECT_LE(cut.depth.mean(), mean_depth) << weight;
    rays = cut.rays.all();
    mean_depth = cut.depth.mean();
    for (std::size_t i = 0; i < cut.image.pixel.size(); ++i) {
      for (int c = 0; c < 3; ++c) {
        const double pixel = cut.image.pixel[i][c], whole = full.image.pixel[i][c];
        ASSERT_LE(std::abs(pixel - whole), double{cut.bound[i][c]}) << "pixel " << i << ", least weight " << weight;
        // Radiance is never negative: what is cut can only be missing. An ulp for the other order of roundings.
        ASSERT_LE(pixel, std::nextafter(before.image.pixel[i][c], 1e9F)) << "pixel " << i << ", least weight " << weight;
      }
    }
    before = std::move(cut);
  }
  EXPECT_EQ(before.rays.reflection + before.rays.refraction, 0) << "above 1 only eye rays are left";
  EXPECT_EQ(before.depth.mean(), 1);
}

TEST_P(DepthControl, TheBoundDoesNotDependOnThreads) {
  const Scene scene = load_scene(GetParam());
  const Rendering one = rendered(scene, {5, 0.1}, 300, 1), many = rendered(scene, {5, 0.1}, 300, 7);
  EXPECT_EQ(std::memcmp(one.bound.data(), many.bound.data(), one.bound.size() * sizeof(glm::vec3)), 0);
  EXPECT_TRUE(same_pixels(one.image, many.image));
}

INSTANTIATE_TEST_SUITE_P(Scenes, DepthControl, testing::Values("spd:balls:2", "spd:gears:1", "spd:mount:3", "spd:rings:2", "spd:teapot:4"));

TEST(DepthControlWeights, ZeroIsCutByNothingButMoreThanZero) {
  // gears' glass has Ks = 0: its reflections weigh exactly nothing, and any least weight above 0 cuts them without changing a bit.
  const Scene scene = load_scene("spd:gears:1");
  const Rendering full = rendered(scene, {3, 0}), cut = rendered(scene, {3, std::numeric_limits<double>::denorm_min()});
  EXPECT_LT(cut.rays.reflection, full.rays.reflection);
  EXPECT_TRUE(same_pixels(full.image, cut.image));
  for (const glm::vec3& bound : cut.bound) ASSERT_EQ(bound, glm::vec3(0));
}

/// Two squares that face each other, of the material that is set, seen from between them.
void add_facing_squares(Scene& scene) {
  scene.add_polygon(std::array<glm::dvec3, 4>{{{-1, -1, 4}, {1, -1, 4}, {1, 1, 4}, {-1, 1, 4}}});
  scene.add_polygon(std::array<glm::dvec3, 4>{{{-1, -1, -4}, {1, -1, -4}, {1, 1, -4}, {-1, 1, -4}}});
  scene.camera = {{0, 0, 0}, {0, 0, 4}, {0, 1, 0}, 45, 0, 1, 1};
}

TEST(DepthControlWeights, OneIsNotCutByOne) {
  for (const double specular : {1.0, 0.999}) {
    Scene scene;
    scene.set_material({{1, 1, 1}, 0, specular, 1, 0, 1});
    add_facing_squares(scene);
    EXPECT_EQ(rendered(scene, {50, 1}, 1).depth.generation.size(), specular == 1 ? 50u : 1u);
  }
}

TEST(RadianceBound, IsReachedByFacingMirrors) {
  // The light is at the eye: each hit gives Kd + Ks, the most there is, and reflects Ks of the rest.
  Scene scene;
  scene.set_material({{1, 0.5, 0.25}, 0.5, 0.5, 4, 0, 1});
  add_facing_squares(scene);
  scene.lights = {{{0, 0, 0}, glm::dvec3(1)}};
  const std::vector<glm::dvec3> largest = largest_radiance(scene, 3);
  EXPECT_EQ(largest[0], glm::dvec3(0));
  EXPECT_EQ(largest[1], glm::dvec3(1, 0.75, 0.625));
  EXPECT_EQ(largest[2], 1.5 * largest[1]);
  EXPECT_EQ(largest[3], 1.75 * largest[1]);
  const Rendering full = rendered(scene, {4, 0}, 1), cut = rendered(scene, {4, 0.75}, 1);
  EXPECT_EQ(full.image.pixel[0] - cut.image.pixel[0], glm::vec3(0.5 * largest[3]));
  for (int c = 0; c < 3; ++c) {
    EXPECT_GE(cut.bound[0][c], 0.5 * largest[3][c]);
    EXPECT_LE(cut.bound[0][c], 0.5 * largest[3][c] * (1 + 1e-5));
  }
}

TEST(RadianceBound, CountsBackgroundBothSharesAndNoBlackLight) {
  Scene scene;
  scene.background = {0.1, 7, 0};
  scene.set_material({{1, 1, 1}, 0.25, 0.5, -1, 0.25, 1.5});  // a negative exponent: highlights without bound
  scene.add_sphere({0, 0, 0}, 1);
  EXPECT_EQ(largest_radiance(scene, 2)[2], glm::dvec3(0.1, 7, 0)) << "no light: 0.75 of the background is less than the background";
  scene.lights = {{{0, 9, 0}, {1, 0, 0}}};
  const glm::dvec3 largest = largest_radiance(scene, 2)[2];
  EXPECT_EQ(largest, glm::dvec3(std::numeric_limits<double>::infinity(), 7, 0));
}

TEST(ShadowRays, SeeALightThatLiesOnASurface) {
  // Case 50: the light lies exactly on the upper square and on a corner of it. Both squares are two-sided; the light's own plane does not face it, and the
  // other is lit, since the light itself is excluded from the shadow ray.
  for (const glm::dvec3& light : {glm::dvec3(0, 0, 4), glm::dvec3(1, 1, 4), glm::dvec3(1, 0, 4)}) {
    Scene scene;
    scene.set_material({{1, 1, 1}, 1, 0, 1, 0, 1});
    add_facing_squares(scene);
    scene.camera.look_at = {0, 0, -4};
    scene.lights = {{light, glm::dvec3(1)}};
    const Rendering lit = rendered(scene, {1, 0}, 1);
    EXPECT_EQ(lit.rays.shadow, 1);
    EXPECT_EQ(lit.rays.shadow_blocked, 0);
    EXPECT_GT(lit.image.pixel[0].x, 0.9F);
    scene.camera.look_at = {0, 0, 4};
    const Rendering own = rendered(scene, {1, 0}, 1);
    EXPECT_EQ(own.rays.shadow, 0);
    EXPECT_EQ(own.image.pixel[0], glm::vec3(0)) << "and not a number that is none";
  }
}

TEST(ShadowRays, AreNotBlockedByTheSurfaceTheyLeaveNorGrazing) {
  Scene scene;
  scene.set_material({{1, 1, 1}, 1, 0, 1, 0, 1});
  for (const double at : {-2.0, 0.0}) scene.add_polygon(std::array<glm::dvec3, 4>{{{at, -1, 0}, {at + 2, -1, 0}, {at + 2, 1, 0}, {at, 1, 0}}});
  scene.camera = {{0.5, 0, 3}, {0, 0, 0}, {0, 1, 0}, 45, 0, 16, 16};
  scene.lights = {{{1000, 0, 1e-3}, glm::dvec3(1)}};  // a millionth above the horizon
  const Rendering out = rendered(scene, {1, 0}, 16);
  EXPECT_EQ(out.rays.shadow, out.rays.primary_hit);
  EXPECT_EQ(out.rays.shadow_blocked, 0);
}

}  // namespace
}  // namespace raymeter
