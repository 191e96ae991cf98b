#include <array>

#include "experiments/scenes/spd/spd_scene.h"
#include "experiments/scenes/spd/teapot_mesh.h"

namespace raymeter {

namespace {

/// The squares of a size x size checkerboard whose row and column add up to an odd or even number.
void add_squares(Scene& scene, int size, int parity) {
  const auto border = [&](int i) { return -4 + 8.0 * i / size; };
  for (int i = 0; i < size; ++i) {
    for (int j = (i + parity) % 2; j < size; j += 2) {
      const std::array<glm::dvec3, 4> square{
          {{border(i), border(j), 0}, {border(i + 1), border(j), 0}, {border(i + 1), border(j + 1), 0}, {border(i), border(j + 1), 0}}};
      scene.add_polygon(square);
    }
  }
}

}  // namespace

Scene make_teapot(int size) {
  Scene scene = spd_scene({4.86, 7.2, 5.4}, {0, 0, 0}, {0, 0, 1}, 1, {{-3.1, 9.8, 12.1}, {11.3, 5.1, 8.8}});
  Material board{.color = {1, 1, 1}, .diffuse = 0.5, .specular = 0.5, .shine = phong_power(30), .ior = 0};
  scene.set_material(board);
  add_squares(scene, size, 1);
  board.color = {0.5, 0.5, 0.5};
  scene.set_material(board);
  add_squares(scene, size, 0);
  scene.set_material({.color = {1, 0.5, 0.1}, .diffuse = 0.75, .specular = 0.25, .shine = phong_power(37), .ior = 0});
  add_teapot(scene, size, 1, {0, 0, 0});
  return scene;
}

}  // namespace raymeter
