#include <array>
#include <cmath>

#include <glm/trigonometric.hpp>

#include "experiments/scenes/spd/spd_scene.h"

namespace raymeter {

namespace {

constexpr double kTubeRadius = 0.07412;
using Pentagon = std::array<glm::dvec3, 5>;

/// The six rings of a set: the pentagonal sections of a dodecahedron's shape, interlocked.
std::array<Pentagon, 6> unit_ring_set() {
  std::array<Pentagon, 6> rings;
  for (std::size_t k = 0; k < 5; ++k) {
    const double angle = glm::radians(72.0 * static_cast<double>(k));
    rings[0][k] = glm::dvec3(std::cos(angle), std::sin(angle), 0) / (1 + kTubeRadius);
  }
  const glm::dmat3 tilt = rotation(2 * std::acos(std::cos(glm::radians(60.0)) / std::sin(glm::radians(36.0))), {1, 0, 0});
  for (std::size_t j = 1; j < 6; ++j) {
    const glm::dmat3 turn = rotation(glm::radians((2 * static_cast<double>(j - 1) + 1) * 36), {0, 0, 1}) * tilt;
    for (std::size_t k = 0; k < 5; ++k) rings[j][k] = turn * rings[0][k];
  }
  return rings;
}

void add_ring_set(Scene& scene, const std::array<Pentagon, 6>& rings, const glm::dvec3& center) {
  constexpr std::array<std::array<int, 3>, 6> kColors{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 1, 1}, {1, 0, 1}, {1, 1, 0}}};
  scene.begin_object("ring set");
  for (std::size_t j = 0; j < 6; ++j) {
    const glm::dvec3 color(kColors[j][0], kColors[j][1], kColors[j][2]);
    scene.set_material({.color = color, .diffuse = 0.5, .specular = 0.2, .shine = phong_power(37), .ior = 0});
    for (std::size_t k = 0; k < 5; ++k) {
      scene.add_cone(center + rings[j][k], kTubeRadius, center + rings[j][(k + 4) % 5], kTubeRadius);
      scene.add_sphere(center + rings[j][k], kTubeRadius);
    }
  }
  scene.end_object();
}

}  // namespace

Scene make_rings(int size) {
  const double spacing = 1 / std::sin(glm::radians(22.5));  // of the layers; the camera looks at their pyramid from its tip
  Scene scene = spd_scene({-1, -spacing, 0.5}, {-1, -spacing + 1, 0.5}, {0, 0, 1}, 1, {{3, -spacing, 3}, {-4, -spacing, 1}, {2, -spacing, -4}});
  scene.set_material({.color = {1, 1, 1}, .diffuse = 1, .specular = 0, .shine = kNoHighlight, .ior = 0});
  const double wall_y = spacing * (size + 1);
  const double half = 1.01 * (wall_y + spacing) * std::tan(glm::radians(22.5));
  const std::array<glm::dvec3, 4> wall{
      {{half - 1, wall_y, half + 0.5}, {-half - 1, wall_y, half + 0.5}, {-half - 1, wall_y, -half + 0.5}, {half - 1, wall_y, -half + 0.5}}};
  scene.add_polygon(wall);
  const std::array<Pentagon, 6> rings = unit_ring_set();
  for (int layer = 0; layer < size; ++layer) {
    for (int i = 0; i <= layer; ++i) {
      for (int j = 0; j <= layer; ++j) add_ring_set(scene, rings, {2 * j - layer, spacing * (layer + 1), 2 * i - layer});
    }
  }
  return scene;
}

}  // namespace raymeter
