#include <array>
#include <cstddef>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/trigonometric.hpp>

#include "experiments/scenes/spd/spd_scene.h"

namespace raymeter {

namespace {

constexpr double kThinning = 0.67;  // of a branch along its length, and from a branch to its children

/// From a child's frame to its parent's: the child grows from the parent's tip.
glm::dmat4 child_frame(double lean_degrees, double turn_degrees, double scale) {
  glm::dmat4 frame = glm::translate(glm::dmat4(1.0), glm::dvec3(0, 0, 1));
  frame = glm::scale(frame, glm::dvec3(scale));
  frame = glm::rotate(frame, glm::radians(turn_degrees), glm::dvec3(0, 0, 1));
  return glm::rotate(frame, glm::radians(lean_degrees), glm::dvec3(1, 0, 0));
}

void add_branch(Scene& scene, const std::array<glm::dmat4, 2>& children, const glm::dmat4& frame, double width, int depth) {
  const glm::dvec3 foot(frame * glm::dvec4(0, 0, 0, 1)), tip(frame * glm::dvec4(0, 0, 1, 1));
  scene.add_cone(foot, 0.15 * width, tip, 0.15 * kThinning * width);
  scene.add_sphere(tip, 0.15 * kThinning * width);
  if (depth == 0) return;
  for (const glm::dmat4& child : children) add_branch(scene, children, frame * child, kThinning * width, depth - 1);
}

}  // namespace

Scene make_tree(int size) {
  Scene scene = spd_scene({4.5, 0.4, 2}, {0, 0, 1.5}, {0, 0, 1}, 1,
                          {{-5, 5, 50}, {30, -30, 30}, {-40, -30, 20}, {10, 30, 40}, {-30, 40, 10}, {50, 25, 20}, {-10, -60, 30}});
  const std::size_t branches = (std::size_t{2} << size) - 1;
  scene.reserve(PrimKind::cone, branches);
  scene.reserve(PrimKind::sphere, branches);
  scene.set_material({.color = {0.2, 0.7, 0.2}, .diffuse = 1, .specular = 0, .shine = kNoHighlight, .ior = 0});
  const std::array<glm::dvec3, 4> field{{{50, 50, 0}, {-50, 50, 0}, {-50, -50, 0}, {50, -50, 0}}};
  scene.add_polygon(field);
  scene.set_material({.color = {0.55, 0.4, 0.2}, .diffuse = 1, .specular = 0, .shine = kNoHighlight, .ior = 0});
  add_branch(scene, {child_frame(40, 90, 0.65), child_frame(25, 230, 0.70)}, glm::dmat4(1.0), 1, size);
  return scene;
}

}  // namespace raymeter
