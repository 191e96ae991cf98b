#include "core/render/whitted.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include <glm/geometric.hpp>

#include "accel/registry.h"
#include "core/render/heat_map.h"
#include "core/render/shading.h"

namespace raymeter {
namespace {

struct Setup {
  std::string_view structure = "bvh";
  Isa isa = best_isa();
  int packet = 16;
  int size = 97;
  Termination termination = {};
  int threads = 1;
  CameraConvention convention = CameraConvention::pixel;
  bool count = false;
};

Rendering rendered(const Scene& scene, const Setup& setup) {
  const TechniqueSpec spec = parse_technique(setup.structure);
  const auto structure = spec.structure->build(scene, spec.params, 1);
  const auto intersector = structure->intersector({setup.isa, setup.packet, spec.params});
  CastFirstHit cast(*intersector);
  return render(scene, cast, *intersector, {{scene.camera, setup.convention, setup.size, setup.size}, setup.termination, setup.threads, setup.count});
}

bool same_pixels(const Image& a, const Image& b) {
  return a.width == b.width && a.height == b.height && std::memcmp(a.pixel.data(), b.pixel.data(), a.pixel.size() * sizeof(glm::vec3)) == 0;
}

/// A cube's six sides, counterclockwise from outside.
void add_cube(Scene& scene, const glm::dvec3& low, double size) {
  for (glm::length_t axis = 0; axis < 3; ++axis) {
    glm::dvec3 u(0), v(0), w(0);
    u[(axis + 1) % 3] = v[(axis + 2) % 3] = w[axis] = size;
    scene.add_polygon(std::array<glm::dvec3, 4>{low, low + v, low + u + v, low + u});
    scene.add_polygon(std::array<glm::dvec3, 4>{low + w, low + w + u, low + w + u + v, low + w + v});
  }
}

/// Every kind of primitive, mirrors, glass, and three lights.
Scene still_life() {
  Scene scene;
  scene.background = {0.1, 0.2, 0.3};
  scene.set_material({{0.8, 0.7, 0.5}, 0.6, 0.3, 20, 0, 0});
  scene.add_polygon(std::array<glm::dvec3, 5>{{{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {0, 2, 0}, {-9, 9, 0}}});
  scene.set_material({{1, 1, 1}, 0.1, 0.1, 100, 0.9, 1.5});
  scene.add_sphere({-0.6, -1.5, 1}, 0.9);
  add_cube(scene, {1.2, -3, 0.1}, 0.8);
  scene.set_material({{0.3, 0.5, 0.9}, 0.5, 0.5, 30, 0, 0});
  scene.add_cone({1.5, 0, 0}, 0.8, {1.5, 0.5, 2}, 0.3);
  scene.set_material({{0.9, 0.3, 0.2}, 0.8, 0.2, 5, 0, 0});
  for (int i = 0; i < 40; ++i) {
    const double a = 0.3 * i, r = 2 + 0.05 * i;
    scene.add_triangle({r * std::cos(a), r * std::sin(a), 0.1 * i}, {r * std::cos(a) + 0.5, r * std::sin(a), 0.1 * i},
                       {r * std::cos(a), r * std::sin(a) + 0.3, 0.1 * i + 0.6});
  }
  scene.lights = {{{5, -5, 8}, glm::dvec3(0.6)}, {{-7, -3, 4}, glm::dvec3(0.5)}, {{0, 8, 3}, glm::dvec3(0.4, 0.5, 0.6)}};
  scene.camera = {{1, -8, 4}, {0, 0, 1}, {0, 0, 1}, 45, 0, 64, 64};
  scene.finish();
  return scene;
}

TEST(Whitted, AnEmptySceneShowsItsBackground) {
  Scene scene;
  scene.background = {0.25, 0.5, 0.75};
  scene.lights = {{{0, 5, 0}, glm::dvec3(1)}};
  for (const StructureEntry& entry : structures()) {
    for (const int size : {1, 5, 33}) {
      const Rendering out = rendered(scene, {.structure = entry.name, .size = size});
      ASSERT_EQ(out.image.pixel.size(), static_cast<std::size_t>(size * size));
      for (const glm::vec3& pixel : out.image.pixel) EXPECT_EQ(pixel, glm::vec3(0.25, 0.5, 0.75));
      EXPECT_EQ(out.rays, (RayCounts{.primary = size * size}));
    }
  }
}

TEST(Whitted, DepthZeroTracesNothingAndDepthOneOnlyEyeRays) {
  const Scene scene = still_life();
  const Rendering none = rendered(scene, {.termination = {.max_depth = 0}});
  EXPECT_EQ(none.rays, RayCounts{});
  for (const glm::vec3& pixel : none.image.pixel) EXPECT_EQ(pixel, glm::vec3(0));
  const Rendering eye = rendered(scene, {.termination = {.max_depth = 1}});
  EXPECT_EQ(eye.rays.primary, 97 * 97);
  EXPECT_GT(eye.rays.shadow, 0);
  EXPECT_EQ(eye.rays.reflection + eye.rays.refraction + eye.rays.tir, 0);
}

TEST(Whitted, WeightsCutNothingAtZeroAndEverythingButEyeRaysAboveOne) {
  const Scene scene = still_life();
  const Rendering full = rendered(scene, {});
  const Rendering eye = rendered(scene, {.termination = {.max_depth = 1}});
  const Rendering above_one = rendered(scene, {.termination = {.min_weight = 1.5}});
  EXPECT_EQ(above_one.rays, eye.rays);
  EXPECT_TRUE(same_pixels(above_one.image, eye.image));
  std::int64_t rays = full.rays.reflection + full.rays.refraction;
  for (const double weight : {0.01, 0.1, 0.5}) {
    const Rendering cut = rendered(scene, {.termination = {.min_weight = weight}});
    EXPECT_LT(cut.rays.reflection + cut.rays.refraction, rays) << weight;
    rays = cut.rays.reflection + cut.rays.refraction;
  }
}

TEST(Whitted, GlassWithoutSpecularWeightStillReflects) {
  // "Whatever its weight": the counts of the Standard Procedural Databases include reflections on gears' glass, whose Ks is 0.
  Scene scene;
  scene.set_material({{1, 1, 1}, 0.2, 0, 1, 0.8, 1.1});
  scene.add_polygon(std::array<glm::dvec3, 4>{{{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}}});
  scene.camera = {{0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 45, 0, 8, 8};
  const RayCounts rays = rendered(scene, {.size = 8}).rays;
  EXPECT_EQ(rays.reflection, 64);
  EXPECT_EQ(rays.refraction, 64);
  EXPECT_EQ(rays.tir, 0);
}

TEST(Whitted, FacingMirrorsSumAGeometricSeries) {
  // Case 53: eye and light on the common normal of two mirrors. Each hit sees the light head on: Kd + Ks. All numbers are dyadic, so the sum is exact.
  for (const double specular : {1.0, 0.5}) {
    Scene scene;
    scene.set_material({{1, 1, 1}, 0.5, specular, 4, 0, 1});
    scene.add_polygon(std::array<glm::dvec3, 4>{{{-1, -1, 4}, {1, -1, 4}, {1, 1, 4}, {-1, 1, 4}}});
    scene.add_polygon(std::array<glm::dvec3, 4>{{{-1, -1, -4}, {1, -1, -4}, {1, 1, -4}, {-1, 1, -4}}});
    scene.camera = {{0, 0, 0}, {0, 0, 4}, {0, 1, 0}, 45, 0, 1, 1};
    scene.lights = {{{0, 0, 0}, glm::dvec3(1)}};
    for (const int depth : {1, 2, 5, 20}) {
      const Rendering out = rendered(scene, {.size = 1, .termination = {.max_depth = depth}});
      const double sum = specular == 1 ? depth : (1 - std::pow(specular, depth)) / (1 - specular);
      EXPECT_EQ(out.image.pixel[0].x, static_cast<float>((0.5 + specular) * sum)) << "depth " << depth;
      EXPECT_EQ(out.rays, (RayCounts{.primary = 1, .primary_hit = 1, .reflection = depth - 1, .reflection_hit = depth - 1, .shadow = depth}));
    }
  }
}

TEST(Whitted, TheImageDoesNotDependOnThreads) {
  const Scene scene = still_life();
  // 300 x 300 pixels are two bands, of many slices each.
  const Rendering one = rendered(scene, {.size = 300, .count = true});
  for (const int threads : {2, 7}) {
    const Rendering many = rendered(scene, {.size = 300, .threads = threads, .count = true});
    EXPECT_TRUE(same_pixels(one.image, many.image)) << threads;
    EXPECT_EQ(one.rays, many.rays) << threads;
    EXPECT_EQ(one.depth, many.depth) << threads;
    for (const FramePhase phase : kFramePhases) EXPECT_EQ(one.totals[phase].counters, many.totals[phase].counters) << threads << ' ' << name(phase);
  }
}

TEST(Whitted, PhasesShareOutRaysTestsAndTime) {
  const Scene scene = still_life();
  const Rendering out = rendered(scene, {.structure = "list", .count = true});
  const auto prims = static_cast<std::uint64_t>(scene.prim_count());
  for (const auto& [phase, rays] : {std::pair{FramePhase::first_hit, out.rays.primary}, std::pair{FramePhase::shadow, out.rays.shadow},
                                    std::pair{FramePhase::reflection, out.rays.reflection}, std::pair{FramePhase::refraction, out.rays.refraction}}) {
    const PhaseTotals& totals = out.totals[phase];
    EXPECT_GT(rays, 0) << name(phase);
    EXPECT_EQ(totals.rays, rays) << name(phase);
    EXPECT_EQ(totals.counters.ray_count, static_cast<std::uint64_t>(rays)) << name(phase);
    if (phase != FramePhase::shadow) {
      EXPECT_EQ(totals.counters.live(Event::prim_test), prims * static_cast<std::uint64_t>(rays)) << name(phase);
    }
    EXPECT_GT(totals.ms, 0) << name(phase);
  }
  EXPECT_EQ(out.totals[FramePhase::shading].rays, 0);
  EXPECT_EQ(out.totals[FramePhase::shading].counters, Counters{});
  EXPECT_GT(out.totals[FramePhase::shading].ms, 0);
  EXPECT_EQ(rendered(scene, {}).totals.sum().counters, Counters{}) << "the timed kernels count nothing";
}

TEST(Whitted, DepthsCountGenerationsAndTheDeepestOfEachEyeRay) {
  // Two facing mirrors fill the left half of the view; the right half meets nothing.
  Scene scene;
  scene.set_material({{1, 1, 1}, 0.5, 0.5, 4, 0, 1});
  scene.add_polygon(std::array<glm::dvec3, 4>{{{-9, -9, 4}, {0, -9, 4}, {0, 9, 4}, {-9, 9, 4}}});
  scene.add_polygon(std::array<glm::dvec3, 4>{{{-99, -99, -4}, {99, -99, -4}, {99, 99, -4}, {-99, 99, -4}}});
  scene.camera = {{0, 0, 0}, {0, 0, 4}, {0, 1, 0}, 45, 0, 8, 8};
  const Rendering out = rendered(scene, {.size = 8, .termination = {.max_depth = 4}});
  const std::int64_t hits = out.rays.primary_hit;
  EXPECT_EQ(hits, 32);
  ASSERT_EQ(out.depth.generation.size(), 4u);
  EXPECT_EQ(out.depth.generation[0], 64);
  EXPECT_EQ(out.depth.generation[1], hits);
  std::int64_t sum = 0;
  for (const std::int64_t rays : out.depth.generation) sum += rays;  // each ray of a chain makes its eye ray one deeper
  EXPECT_EQ(out.depth.deepest_sum, sum);
  EXPECT_EQ(sum, out.rays.primary + out.rays.reflection);
  EXPECT_EQ(out.depth.mean(), static_cast<double>(sum) / 64);
  EXPECT_EQ(rendered(scene, {.size = 8, .termination = {.max_depth = 0}}).depth, DepthCounts{});
}

TEST(Whitted, TheImageDoesNotDependOnStructureOrPacketSize) {
  const Scene scene = still_life();
  for (const Isa isa : kIsas) {
    if (!available(isa)) continue;
    for (const CameraConvention convention : {CameraConvention::pixel, CameraConvention::spd, CameraConvention::havran}) {
      const Rendering list = rendered(scene, {.structure = "list", .isa = isa, .packet = 1, .convention = convention});
      EXPECT_GT(list.rays.tir, 0);
      EXPECT_GT(list.rays.shadow_blocked, 0);
      for (const StructureEntry& entry : structures()) {
        for (const int packet : {1, 8, 64}) {
          const Rendering other = rendered(scene, {.structure = entry.name, .isa = isa, .packet = packet, .convention = convention});
          EXPECT_TRUE(same_pixels(list.image, other.image)) << entry.name << ' ' << name(isa) << " packet " << packet;
          EXPECT_EQ(list.rays, other.rays) << entry.name << ' ' << name(isa) << " packet " << packet;
        }
      }
    }
  }
}

TEST(Whitted, InstructionSetsDifferInTheBoundaryBandOnly) {
  // Hit points are recomputed in double, so that only rays that kernels decide otherwise may differ: those within a few roundings of an outline. A pixel is
  // about 2^-7 wide here and an outline's band 2^-20: of 97 * 97 pixels with some 20 outlines per row none is to be expected; a handful is allowed.
  const Scene scene = still_life();
  const Rendering scalar = rendered(scene, {.isa = Isa::scalar});
  for (const Isa isa : kIsas) {
    if (!available(isa)) continue;
    const Rendering other = rendered(scene, {.isa = isa});
    int differing = 0;
    for (std::size_t i = 0; i < scalar.image.pixel.size(); ++i) differing += scalar.image.pixel[i] == other.image.pixel[i] ? 0 : 1;
    EXPECT_LE(differing, 5) << name(isa);
    EXPECT_EQ(scalar.rays.primary_hit, other.rays.primary_hit) << name(isa);
  }
}

ShadingPoint glass_from_inside(double sine, double ior, const Material& material) {
  ShadingPoint point{};
  point.dir = {sine, 0, std::sqrt(1 - sine * sine)};
  point.surface.geometric = {0, 0, 1};
  point.normal = {0, 0, -1};
  point.material = &material;
  EXPECT_EQ(material.ior, ior);
  return point;
}

TEST(Transmission, TotalReflectionBeginsWithinAnUlpOfTheCriticalAngle) {
  // Case 54: beyond the critical angle nothing is transmitted, below it something is, and no direction is NaN.
  for (const double ior : {1.3, 1.33, 1.5, 1.52, 2.0, 2.42}) {
    Material glass;
    glass.ior = ior;
    double sine = 1 / ior;
    for (int k = 0; k < 64; ++k) sine = std::nextafter(sine, 0);
    for (int k = -64; k <= 64; ++k, sine = std::nextafter(sine, 1)) {
      const auto dir = transmitted(glass_from_inside(sine, ior, glass));
      if (k != 0) {
        EXPECT_EQ(dir.has_value(), k < 0) << ior << ", ulps: " << k;
      }
      if (!dir) continue;
      EXPECT_NEAR(glm::length(*dir), 1, 1e-15);
      EXPECT_NEAR(dir->x, 1, 1e-7) << "grazing: sqrt of 64 ulps off the normal's right angle";
    }
  }
}

TEST(Transmission, IndexOneAndNormalIncidenceGoStraightOn) {
  Material air;
  air.ior = 1;
  Material glass;
  glass.ior = 1.5;
  for (const double sine : {0.0, 0.1, 0.7, 0.999999}) {
    const ShadingPoint point = glass_from_inside(sine, 1, air);
    EXPECT_EQ(transmitted(point), point.dir) << sine;
  }
  EXPECT_EQ(transmitted(glass_from_inside(0, 1.5, glass)), glm::dvec3(0, 0, 1));
}

TEST(Transmission, FollowsSnellBothWays) {
  Material glass;
  glass.ior = 1.5;
  ShadingPoint point = glass_from_inside(0.5, 1.5, glass);
  EXPECT_NEAR(transmitted(point)->x, 0.75, 1e-15) << "out of the medium: 1.5 times the sine";
  EXPECT_GT(transmitted(point)->z, 0);
  point.surface.geometric = {0, 0, -1};
  EXPECT_NEAR(transmitted(point)->x, 0.5 / 1.5, 1e-15) << "into it";
  point.normal = {0, 0, 1};
  EXPECT_NEAR(transmitted(point)->x, 0.5 / 1.5, 1e-15) << "whatever side the shading normal is on";
}

TEST(HeatMap, PixelsCountTheirOwnRay) {
  const Scene scene = still_life();
  const CameraModel model{scene.camera, CameraConvention::pixel, 40, 30};
  const TechniqueSpec spec = parse_technique("list");
  const auto structure = spec.structure->build(scene, spec.params, 1);
  for (const int packet : {1, 16}) {
    const auto intersector = structure->intersector({best_isa(), packet, spec.params});
    const Column<std::uint64_t> tests = events_per_pixel(model, *intersector, Event::prim_test, 2);
    ASSERT_EQ(tests.size(), 1200u);
    for (const std::uint64_t count : tests) EXPECT_EQ(count, static_cast<std::uint64_t>(scene.prim_count()));
  }
}

}  // namespace
}  // namespace raymeter
