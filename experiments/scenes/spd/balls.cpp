#include <array>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "experiments/scenes/spd/spd_scene.h"

namespace raymeter {

namespace {

using Directions = std::array<glm::dvec3, 9>;

/// Where the nine children of a ball that grew along +z sit: six round its equator in two shifted rings, three above it.
Directions child_directions() {
  const double a = 1 / std::numbers::sqrt2;
  const glm::dmat3 tilt = rotation(std::asin(2 / std::sqrt(6.0)), {1, -1, 0});
  const std::array<glm::dvec3, 3> triple{tilt * glm::dvec3(a, a, 0), tilt * glm::dvec3(a, 0, -a), tilt * glm::dvec3(0, a, -a)};
  Directions directions;
  for (std::size_t turn = 0; turn < 3; ++turn) {
    const glm::dmat3 about_z = rotation(glm::radians(120.0 * static_cast<double>(turn)), {0, 0, 1});
    for (std::size_t i = 0; i < 3; ++i) directions[3 * turn + i] = about_z * triple[i];
  }
  return directions;
}

/// The rotation that takes +z to `direction`.
glm::dmat3 from_z(const glm::dvec3& direction) {
  if (direction.z >= 0.9999) return glm::dmat3(1.0);
  if (direction.z <= -0.9999) return rotation(std::numbers::pi, {0, 1, 0});
  return rotation(std::acos(direction.z), glm::cross(glm::dvec3(0, 0, 1), direction));
}

void add_ball(Scene& scene, const Directions& directions, const glm::dvec3& center, double radius, const glm::dvec3& grown_along, int depth) {
  scene.add_sphere(center, radius);
  if (depth == 0) return;
  const glm::dmat3 frame = from_z(grown_along);
  for (const glm::dvec3& child : directions) {
    const glm::dvec3 direction = frame * child;
    add_ball(scene, directions, center + direction * (radius * (1 + 1 / 3.0)), radius / 3, direction, depth - 1);
  }
}

}  // namespace

Scene make_balls(int size) {
  Scene scene = spd_scene({2.1, 1.3, 1.7}, {0, 0, 0}, {0, 0, 1}, 0.01, {{4, 3, 2}, {1, -4, 4}, {-3, 1, 5}});
  std::size_t count = 0;
  for (int depth = 0; depth <= size; ++depth) count = 9 * count + 1;
  scene.reserve(PrimKind::sphere, count);
  scene.set_material({.color = {1, 0.75, 0.33}, .diffuse = 0.8, .specular = 0, .shine = kNoHighlight, .ior = 1});
  const std::array<glm::dvec3, 4> floor{{{12, 12, -0.5}, {-12, 12, -0.5}, {-12, -12, -0.5}, {12, -12, -0.5}}};
  scene.add_polygon(floor);
  scene.set_material({.color = {1, 0.9, 0.7}, .diffuse = 0.5, .specular = 0.5, .shine = phong_power(37), .ior = 1});
  add_ball(scene, child_directions(), {0, 0, 0}, 0.5, {0, 0, 1}, size);
  return scene;
}

}  // namespace raymeter
