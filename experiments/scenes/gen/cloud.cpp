#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "experiments/scenes/gen/gen_scene.h"
#include "experiments/scenes/gen/random_points.h"

namespace raymeter {

namespace {

// Both clouds fill a unit cube evenly, and are as dense as lets a line that crosses it from face to face meet one primitive in the mean, whatever their number.
constexpr double kLargestRadius = 0.25;

Scene cube_scene() { return gen_scene({-0.6, -1.2, 1.3}, {0.5, 0.5, 0.45}, {0, 0, 1}, 45, {-3, -4, 6}); }

}  // namespace

// Equilateral triangles that face any direction. A line meets one of area A with probability A / 2.
Scene make_cloud(int triangles) {
  constexpr std::uint64_t kSeed = 30;
  Scene scene = cube_scene();
  scene.reserve(PrimKind::triangle, static_cast<std::size_t>(triangles));
  scene.set_material({.color = {0.9, 0.7, 0.3}, .diffuse = 0.9});
  const double radius = std::min(kLargestRadius, std::sqrt(8 / (3 * std::numbers::sqrt3 * triangles)));  // circumradius
  for (int i = 0; i < triangles; ++i) {
    RandomStream random(kSeed, static_cast<std::uint64_t>(i));
    const glm::dvec3 center = uniform_in_cube(random, radius, 1 - radius);
    const glm::dvec3 to_corner = uniform_direction(random);
    const glm::dvec3 across = glm::normalize(glm::cross(to_corner, uniform_direction(random)));
    const glm::dvec3 middle = center - radius / 2 * to_corner;
    const glm::dvec3 half_side = radius * std::numbers::sqrt3 / 2 * across;
    scene.add_triangle(center + radius * to_corner, middle + half_side, middle - half_side);
  }
  return scene;
}

// Equal spheres.
Scene make_spheres(int spheres) {
  constexpr std::uint64_t kSeed = 31;
  Scene scene = cube_scene();
  scene.reserve(PrimKind::sphere, static_cast<std::size_t>(spheres));
  scene.set_material({.color = {0.4, 0.6, 0.9}, .diffuse = 0.7, .specular = 0.3, .shine = 20});
  const double radius = std::min(kLargestRadius, std::sqrt(std::numbers::inv_pi / spheres));
  for (int i = 0; i < spheres; ++i) {
    RandomStream random(kSeed, static_cast<std::uint64_t>(i));
    scene.add_sphere(uniform_in_cube(random, radius, 1 - radius), radius);
  }
  return scene;
}

}  // namespace raymeter
