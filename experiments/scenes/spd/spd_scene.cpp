#include "experiments/scenes/spd/spd_scene.h"

#include <cmath>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/trigonometric.hpp>

#include "experiments/scenes/nff_defaults.h"

namespace raymeter {

double phong_power(double half_angle_degrees) noexcept { return std::log(0.5) / std::log(std::cos(glm::radians(half_angle_degrees))); }

Scene spd_scene(const glm::dvec3& eye, const glm::dvec3& look_at, const glm::dvec3& up, double hither, std::initializer_list<glm::dvec3> lights) {
  Scene scene;
  scene.background = {0.078, 0.361, 0.753};
  scene.camera = {.eye = eye, .look_at = look_at, .up = up, .fov_degrees = 45, .hither = hither, .width = 512, .height = 512};
  for (const glm::dvec3& position : lights) scene.lights.push_back({position, default_light_color(lights.size())});
  return scene;
}

glm::dmat3 rotation(double radians, const glm::dvec3& axis) { return glm::dmat3(glm::rotate(glm::dmat4(1.0), radians, axis)); }

}  // namespace raymeter
