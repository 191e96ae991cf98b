#include "core/ray/generators_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>

#include <glm/geometric.hpp>

#include "accel/registry.h"
#include "core/trace/trace.h"

namespace raymeter {
namespace {

/// A ball over a floor with two lights, one of them below the floor.
Scene ball_on_floor() {
  Scene scene;
  scene.add_sphere({0, 0, 1}, 1);
  scene.add_polygon(std::array<glm::dvec3, 4>{{{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}}});
  scene.lights = {{{5, -5, 8}, glm::dvec3(1)}, {{0, 0, -4}, glm::dvec3(1)}};
  scene.camera = {{0, -6, 2}, {0, 0, 1}, {0, 0, 1}, 45, 0, 64, 64};
  scene.finish();
  return scene;
}

struct Traced {
  std::unique_ptr<Structure> structure;
  std::unique_ptr<Intersector> tracer;
};

Traced list_over(const Scene& scene) {
  const TechniqueSpec spec = parse_technique("list");
  Traced traced{spec.structure->build(scene, spec.params, 1), nullptr};
  traced.tracer = traced.structure->intersector({best_isa(), 16, spec.params});
  return traced;
}

RaySet rays_of(const Scene& scene, const RayRecipe& recipe, int threads = 1, std::uint64_t seed = 42) {
  const Traced list = list_over(scene);
  return make_rays(scene, recipe, {scene.camera, CameraConvention::pixel, 61, 45}, seed, *list.tracer, threads);
}

bool same_rays(const RaySet& a, const RaySet& b) {
  if (a.rays.size() != b.rays.size() || a.query != b.query) return false;
  for (std::size_t i = 0; i < a.rays.size(); ++i) {
    const Ray p = a.rays[i], q = b.rays[i];
    if (std::memcmp(&p, &q, sizeof(Ray)) != 0 || a.pixel[i] != b.pixel[i]) return false;  // NaN among them
  }
  return true;
}

TEST(Generators, EveryKindIsTheSameOnAnyNumberOfThreads) {
  const Scene scene = ball_on_floor();
  for (const RayKind kind : kRayKinds) {
    const RaySet one = rays_of(scene, kind, 1);
    EXPECT_GT(one.rays.size(), 0u) << name(kind);
    EXPECT_EQ(one.rays.size(), one.pixel.size());
    for (const int threads : {2, 7}) EXPECT_TRUE(same_rays(one, rays_of(scene, kind, threads))) << name(kind);
    const bool seeded = kind != RayKind::primary && kind != RayKind::shadow && kind != RayKind::reflection;
    EXPECT_EQ(same_rays(one, rays_of(scene, kind, 1, 43)), !seeded) << name(kind);
    EXPECT_EQ(ray_kind_from_name(name(kind)), kind);
  }
  EXPECT_EQ(ray_kind_from_name("primry"), std::nullopt);
}

TEST(Generators, RecipesAreReadAsTheyAreNamed) {
  for (const char* text : {"diffuse", "diffuse:offset=bound", "shadow:offset=0.001", "ambient_occlusion:offset=16ulp", "reflection:offset=0"}) {
    const auto recipe = ray_recipe_from_name(text);
    ASSERT_TRUE(recipe.has_value()) << text;
    EXPECT_EQ(name(*recipe), text);
  }
  EXPECT_EQ(name(*ray_recipe_from_name("diffuse:offset=1e-3")), "diffuse:offset=0.001");
  for (const char* text :
       {"primary:offset=1", "diffuse:offset=", "diffuse:offset=-1", "diffuse:offset=inf", "diffuse:offset=2ulps", "diffuse:ofset=1", "rays"}) {
    EXPECT_FALSE(ray_recipe_from_name(text).has_value()) << text;
  }
}

/// Two squares 0.01 apart, seen between them: rays that leave one meet the other, unless they begin beyond it.
TEST(Generators, OffsetsLiftOriginsAndAreHeldAgainstTheBound) {
  Scene scene;
  for (const double z : {0.1, 0.11}) scene.add_polygon(std::array<glm::dvec3, 4>{{{-9, -9, z}, {9, -9, z}, {9, 9, z}, {-9, 9, z}}});
  scene.camera = {{0, -8, 0.105}, {0, 0, 0.105}, {0, 0, 1}, 1, 0, 64, 64};
  scene.finish();
  const RaySet plain = rays_of(scene, RayKind::diffuse);
  EXPECT_TRUE(plain.expected.prim.empty());
  const Traced list = list_over(scene);
  struct Rule {
    const char* name;
    float least, most;  ///< of the origins' distances from the surface
  };
  for (const Rule& rule : {Rule{"diffuse:offset=bound", 0, 1e-4f}, Rule{"diffuse:offset=0.005", 0.004999f, 0.005001f},
                           Rule{"diffuse:offset=0.02", 0.01999f, 0.02001f}, Rule{"diffuse:offset=0", 0, 1e-8f}, Rule{"diffuse:offset=4096ulp", 0, 0.005f}}) {
    const RaySet set = rays_of(scene, *ray_recipe_from_name(rule.name));
    ASSERT_EQ(set.rays.size(), plain.rays.size()) << rule.name;
    ASSERT_EQ(set.expected.prim.size(), set.rays.size()) << rule.name;
    EXPECT_EQ(std::ranges::count(set.expected.excused.span(), true), static_cast<std::ptrdiff_t>(set.rays.size()));
    HitBatch hits;
    trace_closest(*list.tracer, set.rays, hits, 1);
    std::size_t wrong = 0, self = 0;
    for (std::size_t i = 0; i < set.rays.size(); ++i) {
      const std::int32_t source = set.expected.source[i];
      const float lift = std::abs(set.rays[i].org[2] - (source == 0 ? 0.1f : 0.11f));
      EXPECT_TRUE(lift >= rule.least && lift <= rule.most) << rule.name << ' ' << lift;
      wrong += hits.prim[i] != set.expected.prim[i] ? 1 : 0;
      self += hits.prim[i] == source ? 1 : 0;
    }
    const bool right = rule.most < 0.01f && rule.most > 1e-7f;
    EXPECT_EQ(wrong > 0, !right) << rule.name;
    EXPECT_EQ(self > 0, rule.most <= 1e-7f) << rule.name;
  }
  EXPECT_TRUE(same_rays(plain, rays_of(scene, *ray_recipe_from_name("diffuse:offset=bound"))));
}

TEST(Generators, ShadowRaysEndOneUlpBelowTheirLightAndStartOnTheEyesSide) {
  const Scene scene = ball_on_floor();
  const RaySet set = rays_of(scene, RayKind::shadow);
  const RaySet primary = rays_of(scene, RayKind::primary);
  EXPECT_EQ(set.query, Query::any);
  // The light below the floor is behind every surface that the eye sees but the ball's lower half.
  for (std::size_t i = 0; i < set.rays.size(); ++i) {
    const Ray ray = set.rays[i];
    EXPECT_EQ(ray.t_min, 0);
    EXPECT_EQ(ray.t_max, std::nextafterf(1, 0));
    const glm::dvec3 end(ray.org[0] + ray.dir[0], ray.org[1] + ray.dir[1], ray.org[2] + ray.dir[2]);
    const double off = std::min(glm::length(end - scene.lights[0].position), glm::length(end - scene.lights[1].position));
    EXPECT_LT(off, 1e-5);  // float roundings of coordinates below 16
    EXPECT_GT(ray.org[2], 0);
  }
  EXPECT_LT(set.rays.size(), 2 * primary.rays.size());
}

TEST(Generators, ReflectionsOnTheFloorGoUpAtTheAngleTheyCameIn) {
  Scene scene;
  scene.add_polygon(std::array<glm::dvec3, 4>{{{-99, -99, 0}, {99, -99, 0}, {99, 99, 0}, {-99, 99, 0}}});
  scene.camera = {{0, -6, 2}, {0, 0, 0}, {0, 0, 1}, 30, 0, 64, 64};
  const RaySet set = rays_of(scene, RayKind::reflection);
  const RaySet primary = rays_of(scene, RayKind::primary);
  ASSERT_EQ(set.rays.size(), primary.rays.size());
  for (std::size_t i = 0; i < set.rays.size(); ++i) {
    EXPECT_EQ(set.rays[i].dir[0], primary.rays[i].dir[0]);
    EXPECT_EQ(set.rays[i].dir[2], -primary.rays[i].dir[2]);
    EXPECT_EQ(set.pixel[i], primary.pixel[i]);
  }
}

TEST(Generators, DiffuseDirectionsHaveTheCosineDistribution) {
  Scene scene;
  scene.add_polygon(std::array<glm::dvec3, 4>{{{-99, 0, -99}, {-99, 0, 99}, {99, 0, 99}, {99, 0, -99}}});
  scene.camera = {{0, 6, 2}, {0, 0, 0}, {0, 0, 1}, 60, 0, 64, 64};
  const Traced list = list_over(scene);
  const RaySet set = make_rays(scene, RayKind::diffuse, {scene.camera, CameraConvention::pixel, 200, 200}, 7, *list.tracer, 1);
  ASSERT_EQ(set.rays.size(), 40000u);
  // For density cos / pi the mean of cos is 2/3, of cos^2 1/2; their standard errors over 40000 rays are 0.0012 and 0.0014.
  double cosine = 0, cosine2 = 0;
  for (std::size_t i = 0; i < set.rays.size(); ++i) {
    const double c = double{set.rays[i].dir[1]};
    EXPECT_GE(c, 0);
    cosine += c;
    cosine2 += c * c;
  }
  EXPECT_NEAR(cosine / 40000, 2.0 / 3, 5 * 0.0012);
  EXPECT_NEAR(cosine2 / 40000, 0.5, 5 * 0.0014);
}

TEST(Generators, RandomLinesMeetAConvexBodyInProportionToItsArea) {
  // Crofton: of the lines that meet the box, those that meet the ball inside it are the ratio of the surface areas.
  Scene scene;
  scene.add_sphere({0, 0, 0}, 1);
  scene.add_sphere({1.5, 0.5, -1}, 0);  // stretches the box without being a target
  scene.finish();
  const Traced list = list_over(scene);
  const int count = 200;
  const RaySet set = make_rays(scene, RayKind::random, {scene.camera, CameraConvention::pixel, count, count}, 3, *list.tracer, 1);
  HitBatch hits;
  trace_closest(*list.tracer, set.rays, hits, 1);
  int met = 0;
  for (const std::int32_t prim : hits.prim) met += prim == 0 ? 1 : 0;
  const double share = 4 * std::numbers::pi / (2 * (2.5 * 2 + 2 * 2 + 2.5 * 2));
  const double standard_error = std::sqrt(share * (1 - share) / (count * count));
  EXPECT_NEAR(static_cast<double>(met) / (count * count), share, 5 * standard_error);
}

Scene tetrahedron(bool closed) {
  const std::array<glm::dvec3, 4> v{{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}};
  Scene scene;
  for (std::size_t k = 0; k < (closed ? 4u : 3u); ++k) scene.add_triangle(v[k], v[(k + 1) % 4], v[(k + 2) % 4]);
  scene.camera = {{0, -6, 2}, {0, 0, 0}, {0, 0, 1}, 30, 0, 64, 64};
  scene.finish();
  return scene;
}

TEST(Generators, RaysAtAClosedMeshAllHit) {
  for (const bool closed : {true, false}) {
    const Scene scene = tetrahedron(closed);
    EXPECT_EQ(is_closed(scene), closed);
    for (const RayKind kind : {RayKind::vertices, RayKind::edges, RayKind::faces}) {
      const RaySet set = rays_of(scene, kind);
      ASSERT_EQ(set.rays.size(), 61u * 45u);
      EXPECT_EQ(set.expected.prim.size(), closed ? set.rays.size() : 0u);
      if (!closed) continue;
      const Traced list = list_over(scene);
      HitBatch hits;
      trace_closest(*list.tracer, set.rays, hits, 1);
      EXPECT_EQ(std::count(hits.prim.begin(), hits.prim.end(), -1), 0) << name(kind);
    }
  }
  EXPECT_FALSE(is_closed(ball_on_floor()));
}

/// Six sides of two triangles each.
void add_box(Scene& scene, const glm::dvec3& low, double size) {
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 across(0.0), up(0.0);
    across[(axis + 1) % 3] = up[(axis + 2) % 3] = size;
    for (const double side : {0.0, size}) {
      glm::dvec3 a = low;
      a[axis] += side;
      scene.add_triangle(a, a + across, a + across + up);
      scene.add_triangle(a, a + across + up, a + up);
    }
  }
}

TEST(Generators, RaysAtAMeshStartInsideOfItsSolids) {
  for (const double scale : {0.3, 0.7, 1.0, 1.9, 3.3, 11.7}) {
    Scene boxes;  // with facets in the sides of the scene's box
    add_box(boxes, {0.1 * scale, 0.2 * scale, 0.3 * scale}, 0.7 * scale);
    add_box(boxes, glm::dvec3(1.3 * scale), 0.7 * scale);
    boxes.camera = tetrahedron(true).camera;
    boxes.finish();
    const Traced list = list_over(boxes);
    for (const RayKind kind : {RayKind::vertices, RayKind::edges, RayKind::faces}) {
      const RaySet set = rays_of(boxes, kind);
      EXPECT_EQ(set.expected.prim.size(), set.rays.size());
      HitBatch hits;
      trace_closest(*list.tracer, set.rays, hits, 1);
      EXPECT_EQ(std::count(hits.prim.begin(), hits.prim.end(), -1), 0) << name(kind) << ", scale " << scale;
    }
  }
}

TEST(Generators, ASheetOfTwoSidesIsNotClosed) {
  Scene sheet;
  const glm::dvec3 a(0, 0, 0), b(1, 0, 0), c(1, 1, 0), d(0, 1, 0);
  for (const bool back : {false, true}) {
    sheet.add_triangle(a, back ? c : b, back ? b : c);
    sheet.add_triangle(a, back ? d : c, back ? c : d);
  }
  sheet.finish();
  EXPECT_FALSE(is_closed(sheet));
}

TEST(Generators, EveryEighthRayIsInvalid) {
  const Scene scene = ball_on_floor();
  const RaySet set = rays_of(scene, RayKind::invalid), valid = rays_of(scene, RayKind::primary);
  const Traced list = list_over(scene);
  HitBatch hits, expected;
  trace_closest(*list.tracer, set.rays, hits, 1);
  trace_closest(*list.tracer, valid.rays, expected, 1);
  for (std::size_t i = 0; i < set.rays.size(); ++i) {
    EXPECT_EQ(set.expected.prim[i], i % 8 == 7 ? ExpectedHits::kNothing : ExpectedHits::kUnknown);
    EXPECT_EQ(hits.prim[i], i % 8 == 7 ? -1 : expected.prim[i]);
  }
}

TEST(Generators, AnEmptySceneHasOnlyEyeRays) {
  Scene scene;
  scene.finish();
  for (const RayKind kind : kRayKinds)
    EXPECT_EQ(rays_of(scene, kind).rays.size(), kind == RayKind::primary || kind == RayKind::invalid ? 61u * 45u : 0u) << name(kind);
}

}  // namespace
}  // namespace raymeter
