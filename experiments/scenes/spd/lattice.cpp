#include <array>
#include <cstddef>

#include "experiments/scenes/spd/spd_scene.h"

namespace raymeter {

namespace {

/// Along x red, along y green, along z blue.
Material rod_material(glm::length_t axis) {
  Material material{.color = glm::dvec3(0.1), .diffuse = 0.99, .specular = 0, .shine = kNoHighlight, .ior = 0};
  material.color[axis] = 0.9;
  return material;
}

}  // namespace

Scene make_lattice(int size) {
  const double s = size;
  const double middle = (size / 2 + 0.5) / s;  // NOLINT(bugprone-integer-division): the middle of a row of cells
  Scene scene = spd_scene({middle, 1, 1 - 1 / (2 * s)}, {middle, -1, -1 - 1 / (2 * s)}, {0.2, 1, 0}, 0,
                          {{2, 0.5, 0.5}, {-1, 0.5, 0.5}, {0.5, 2, 0.5}, {0.5, -1, 0.5}, {0.5, 0.5, 2}, {0.5, 0.5, -1}});
  scene.camera.fov_degrees = 60;
  const auto points = static_cast<std::size_t>(size + 1);
  scene.reserve(PrimKind::sphere, points * points * points);
  scene.reserve(PrimKind::cone, 3 * static_cast<std::size_t>(size) * points * points);
  const Material ball_material{.color = {0.9, 0.9, 0.9}, .diffuse = 0.5, .specular = 0.5, .shine = phong_power(37), .ior = 0};
  const double ball_radius = 1 / (4 * s), rod_radius = 1 / (16 * s);
  // Rods end inside the balls, near to where rods of twice their radius would leave them.
  const double inset = 0.99 * ball_radius * (1 - 0.5);
  for (int x = 0; x <= size; ++x) {
    for (int y = 0; y <= size; ++y) {
      for (int z = 0; z <= size; ++z) {
        const glm::ivec3 index(x, y, z);
        const glm::dvec3 point = glm::dvec3(index) / s;
        scene.set_material(ball_material);
        scene.add_sphere(point, ball_radius);
        for (glm::length_t axis = 0; axis < 3; ++axis) {
          if (index[axis] == size) continue;
          glm::dvec3 from = point, to = point;
          from[axis] += inset;
          to[axis] = (index[axis] + 1) / s - inset;
          scene.set_material(rod_material(axis));
          scene.add_cone(from, rod_radius, to, rod_radius);
        }
      }
    }
  }
  return scene;
}

}  // namespace raymeter
