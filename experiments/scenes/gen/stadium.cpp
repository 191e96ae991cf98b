#include <array>
#include <cmath>
#include <numbers>

#include "experiments/scenes/gen/gen_scene.h"
#include "experiments/scenes/spd/teapot_mesh.h"

namespace raymeter {

namespace {

// Metres.
constexpr int kSectors = 96;
constexpr int kTiers = 30;
constexpr double kTierHeight = 0.5;

void add_quad(Scene& scene, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
  scene.add_triangle(a, b, c);
  scene.add_triangle(a, c, d);
}

void add_rectangle(Scene& scene, double half_x, double half_y, double z) {
  add_quad(scene, {-half_x, -half_y, z}, {half_x, -half_y, z}, {half_x, half_y, z}, {-half_x, half_y, z});
}

glm::dvec3 on_ellipse(double radius_x, double radius_y, double angle, double z) { return {radius_x * std::cos(angle), radius_y * std::sin(angle), z}; }

/// A point at the inner edge of a tier (tier 30: at the outer edge of the last).
glm::dvec3 bowl_point(int sector, int tier, double z) { return on_ellipse(60 + tier, 45 + tier, 2 * std::numbers::pi * (sector % kSectors) / kSectors, z); }

void add_bowl(Scene& scene) {
  scene.begin_object("bowl");
  for (int tier = 0; tier < kTiers; ++tier) {
    const double foot = tier * kTierHeight, top = foot + kTierHeight;
    for (int s = 0; s < kSectors; ++s) {
      add_quad(scene, bowl_point(s, tier, foot), bowl_point(s + 1, tier, foot), bowl_point(s + 1, tier, top), bowl_point(s, tier, top));
      add_quad(scene, bowl_point(s, tier, top), bowl_point(s + 1, tier, top), bowl_point(s + 1, tier + 1, top), bowl_point(s, tier + 1, top));
    }
  }
  const double top = kTiers * kTierHeight;
  for (int s = 0; s < kSectors; ++s)
    add_quad(scene, bowl_point(s + 1, kTiers, 0), bowl_point(s, kTiers, 0), bowl_point(s, kTiers, top), bowl_point(s + 1, kTiers, top));
  scene.end_object();
}

void add_pylon(Scene& scene, const glm::dvec3& foot) {
  constexpr double kHalf = 0.3;
  const glm::dvec3 up(0, 0, 45);
  const std::array<glm::dvec3, 4> corner{foot + glm::dvec3(kHalf, kHalf, 0), foot + glm::dvec3(-kHalf, kHalf, 0), foot + glm::dvec3(-kHalf, -kHalf, 0),
                                         foot + glm::dvec3(kHalf, -kHalf, 0)};
  scene.begin_object("pylon");
  for (std::size_t k = 0; k < 4; ++k) {
    const glm::dvec3 &a = corner[k], &b = corner[(k + 1) % 4];
    add_quad(scene, a, b, b + up, a + up);
  }
  scene.end_object();
}

}  // namespace

Scene make_stadium(int teapot_divisions) {
  Scene scene = gen_scene({0.4, 0.55, 0.35}, {0, 0, 0.06}, {0, 0, 1}, 45, {12, 25, 40});
  scene.set_material({.color = {0.5, 0.45, 0.35}, .diffuse = 0.9});
  add_rectangle(scene, 200, 200, -0.05);
  scene.set_material({.color = {0.3, 0.6, 0.25}, .diffuse = 0.9});
  add_rectangle(scene, 52, 34, 0);
  scene.set_material({.color = {0.7, 0.7, 0.7}, .diffuse = 0.9});
  add_bowl(scene);
  for (int k = 0; k < 8; ++k) add_pylon(scene, on_ellipse(98, 83, (k + 0.5) * std::numbers::pi / 4, 0));
  scene.set_material({.color = {1, 0.5, 0.1}, .diffuse = 0.75, .specular = 0.25, .shine = 3});
  add_teapot(scene, teapot_divisions, 0.05, {0, 0, 0.001});
  return scene;
}

}  // namespace raymeter
