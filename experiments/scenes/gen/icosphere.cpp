#include <array>
#include <cstddef>
#include <numbers>

#include <glm/geometric.hpp>

#include "experiments/scenes/gen/gen_scene.h"

namespace raymeter {

namespace {

/// Neighbours get the same midpoint bit for bit, since a sum does not depend on the order of its two terms: the mesh is closed.
void add_face(Scene& scene, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, int subdivisions) {
  if (subdivisions == 0) return scene.add_triangle(a, b, c);
  const glm::dvec3 ab = glm::normalize(a + b), bc = glm::normalize(b + c), ca = glm::normalize(c + a);
  add_face(scene, a, ab, ca, subdivisions - 1);
  add_face(scene, ab, b, bc, subdivisions - 1);
  add_face(scene, ca, bc, c, subdivisions - 1);
  add_face(scene, ab, bc, ca, subdivisions - 1);
}

/// The corners of an icosahedron with edges of length 2: (0, +-1, +-golden ratio) and its cyclic permutations.
std::array<glm::dvec3, 12> icosahedron() {
  std::array<glm::dvec3, 12> corners;
  std::size_t count = 0;
  for (glm::length_t axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      for (const double top : {-std::numbers::phi, std::numbers::phi}) {
        glm::dvec3 corner(0.0);
        corner[(axis + 1) % 3] = side;
        corner[(axis + 2) % 3] = top;
        corners[count++] = corner;
      }
    }
  }
  return corners;
}

}  // namespace

// The unit sphere.
Scene make_icosphere(int subdivisions) {
  Scene scene = gen_scene({-1.5, -3.5, 1.5}, {0, 0, 0}, {0, 0, 1}, 35, {-3, -4, 6});
  scene.reserve(PrimKind::triangle, std::size_t{20} << (2 * subdivisions));
  scene.set_material({.color = {0.8, 0.8, 0.8}, .diffuse = 0.9});
  scene.begin_object("icosphere");
  const std::array<glm::dvec3, 12> corners = icosahedron();
  // Of two corners that are no neighbours the distance is at least 2 phi = 3.2.
  const auto neighbours = [](const glm::dvec3& p, const glm::dvec3& q) { return glm::distance(p, q) < 3; };
  for (std::size_t i = 0; i < corners.size(); ++i) {
    for (std::size_t j = i + 1; j < corners.size(); ++j) {
      for (std::size_t k = j + 1; k < corners.size(); ++k) {
        const glm::dvec3 &p = corners[i], &q = corners[j], &r = corners[k];
        if (!neighbours(p, q) || !neighbours(q, r) || !neighbours(r, p)) continue;
        const bool outwards = glm::dot(glm::cross(q - p, r - p), p) > 0;
        add_face(scene, glm::normalize(p), glm::normalize(outwards ? q : r), glm::normalize(outwards ? r : q), subdivisions);
      }
    }
  }
  scene.end_object();
  return scene;
}

}  // namespace raymeter
