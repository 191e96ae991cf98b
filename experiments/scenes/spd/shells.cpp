#include <cmath>
#include <cstddef>
#include <numbers>

#include "experiments/scenes/spd/spd_scene.h"

namespace raymeter {

Scene make_shells(int size) {
  Scene scene = spd_scene({-6, -60, 35}, {0, 8, -15}, {0, 0, 1}, 0.5, {{-100, -100, 100}});
  scene.set_material({.color = {1, 0.8, 0.4}, .diffuse = 0.8, .specular = 0.2, .shine = phong_power(10), .ior = 1});
  const int steps = 180 * (1 << size);
  scene.reserve(PrimKind::sphere, static_cast<std::size_t>(steps) + 1);
  for (int i = -(2 * (steps / 3)); i <= steps / 3; ++i) {
    const double angle = 18 * std::numbers::pi * i / steps;
    const double radius = std::exp(0.15 * angle);
    scene.add_sphere({radius * std::sin(angle), radius * std::cos(angle), -2 * radius}, radius);
  }
  return scene;
}

}  // namespace raymeter
