#include <cstddef>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/trigonometric.hpp>

#include "experiments/scenes/spd/spd_scene.h"

namespace raymeter {

namespace {

/// One jack: three crossed rods with a ball at each of their six ends.
void add_jack(Scene& scene, const glm::dmat4& frame, double scale) {
  const double size = 0.75;
  const auto end = [&](glm::length_t axis, double sign) {
    glm::dvec4 point(0, 0, 0, 1);
    point[axis] = sign * size;
    return glm::dvec3(frame * point);
  };
  scene.begin_object("jack");
  for (glm::length_t axis = 0; axis < 3; ++axis) scene.add_cone(end(axis, -1), 0.1 * size * scale, end(axis, 1), 0.1 * size * scale);
  for (const double sign : {1.0, -1.0}) {
    for (glm::length_t axis = 0; axis < 3; ++axis) scene.add_sphere(end(axis, sign), 0.2 * size * scale);
  }
  scene.end_object();
}

/// A jack and, for each further level, eight copies of half its size towards the corners of a cube round it.
void add_jacks(Scene& scene, const glm::dmat4& frame, double scale, int levels) {
  add_jack(scene, frame, scale);
  if (levels == 1) return;
  for (const double x : {-0.5, 0.5}) {
    for (const double y : {-0.5, 0.5}) {
      for (const double z : {-0.5, 0.5}) add_jacks(scene, glm::scale(glm::translate(frame, glm::dvec3(x, y, z)), glm::dvec3(0.5)), scale / 2, levels - 1);
    }
  }
}

}  // namespace

Scene make_jacks(int size) {
  Scene scene = spd_scene({0, 0, -8}, {0, 0, 0}, {0, 1, 0}, 0.001, {{-10, 3, -20}});
  scene.background = {0.2, 0.05, 0.2};
  scene.camera.fov_degrees = 25;
  scene.camera.width = scene.camera.height = 256;
  scene.set_material({.color = {0.737, 0.561, 0.561}, .diffuse = 0.7, .specular = 0.7, .shine = phong_power(20), .ior = 1});
  const std::size_t jacks = ((std::size_t{1} << (3 * size)) - 1) / 7;
  scene.reserve(PrimKind::cone, 3 * jacks);
  scene.reserve(PrimKind::sphere, 6 * jacks);
  const glm::dmat3 tilt = rotation(glm::radians(-30.0), {1, 0, 0}) * rotation(glm::radians(-20.0), {0, 1, 0});
  add_jacks(scene, glm::dmat4(tilt), 1, size);
  return scene;
}

}  // namespace raymeter
