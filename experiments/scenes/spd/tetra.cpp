#include <array>

#include "experiments/scenes/spd/spd_scene.h"

namespace raymeter {

namespace {

/// Every other corner of a cube, in the order of x, y, z.
constexpr std::array<std::array<int, 3>, 4> kCorners{{{-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}, {1, 1, 1}}};
constexpr std::array<std::array<std::size_t, 3>, 4> kFaces{{{0, 1, 2}, {3, 2, 1}, {2, 3, 0}, {1, 0, 3}}};

void add_pyramid(Scene& scene, const glm::dvec3& center, double half_width, int depth) {
  std::array<glm::dvec3, 4> corner;
  const double reach = depth > 1 ? half_width / 2 : half_width;
  for (std::size_t k = 0; k < 4; ++k) corner[k] = center + reach * glm::dvec3(kCorners[k][0], kCorners[k][1], kCorners[k][2]);
  if (depth > 1) {
    for (const glm::dvec3& part : corner) add_pyramid(scene, part, half_width / 2, depth - 1);
  } else {
    for (const auto& [a, b, c] : kFaces) scene.add_triangle(corner[a], corner[b], corner[c]);
  }
}

}  // namespace

Scene make_tetra(int size) {
  Scene scene = spd_scene({1.022846, -3.177154, -2.174512}, {-0.004103, -0.004103, 0.216539}, {-0.816497, -0.816497, 0.816497}, 1, {{2, -18, -5}});
  scene.reserve(PrimKind::triangle, std::size_t{1} << (2 * size));
  scene.set_material({.color = {1, 0.2, 0.2}, .diffuse = 1, .specular = 0, .shine = kNoHighlight, .ior = 0});
  add_pyramid(scene, {0, 0, 0}, 1, size);
  return scene;
}

}  // namespace raymeter
