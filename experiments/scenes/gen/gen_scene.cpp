#include "experiments/scenes/gen/gen_scene.h"

namespace raymeter {

Scene gen_scene(const glm::dvec3& eye, const glm::dvec3& look_at, const glm::dvec3& up, double fov_degrees, const glm::dvec3& light) {
  Scene scene;
  scene.background = {0.6, 0.75, 0.9};
  scene.camera = {.eye = eye, .look_at = look_at, .up = up, .fov_degrees = fov_degrees, .width = 512, .height = 512};
  scene.lights = {{light, glm::dvec3(1.0)}};
  return scene;
}

}  // namespace raymeter
