#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "experiments/scenes/spd/spd_scene.h"

namespace raymeter {

Scene make_sombrero(int size) {
  Scene scene = spd_scene({0, 5, -8}, {0, 0, 0}, {0, 0, 1}, 0.01, {{10, 10, -10}});
  scene.camera.fov_degrees = 40;
  scene.set_material({.color = {1, 0.1, 0.1}, .diffuse = 0.8, .specular = 0, .shine = phong_power(40), .ior = 1});
  const auto samples = std::size_t{32} << (size - 1);
  const double n = static_cast<double>(samples);
  scene.reserve(PrimKind::triangle, 2 * (samples - 1) * (samples - 1));
  // The original spreads its samples over all of the square but one step, and draws them over all of it.
  const auto sample = [&](std::size_t i) { return -4 + 8 * static_cast<double>(i) / n; };
  const auto drawn = [&](std::size_t i) { return -4 + 8 * static_cast<double>(i) / (n - 1); };
  std::vector<glm::dvec3> row(samples), next(samples);
  const auto fill = [&](std::vector<glm::dvec3>& points, std::size_t j) {
    for (std::size_t i = 0; i < samples; ++i) {
      const double distance = std::hypot(sample(i), sample(j));
      points[i] = {drawn(i), -3 + std::cos(2 * std::numbers::pi * distance) * std::exp(-distance), drawn(j)};
    }
  };
  fill(row, 0);
  for (std::size_t j = 1; j < samples; ++j) {
    fill(next, j);
    for (std::size_t i = 1; i < samples; ++i) {
      scene.add_triangle(row[i - 1], next[i], row[i]);
      scene.add_triangle(row[i - 1], next[i - 1], next[i]);
    }
    row.swap(next);
  }
  return scene;
}

}  // namespace raymeter
