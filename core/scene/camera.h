#pragma once

#include <glm/vec3.hpp>

namespace raymeter {

/// A pinhole camera in NFF's terms. Vectors need not be normalised, `up` need not be orthogonal. The field of view is the full angle of both axes, in degrees.
struct Camera {
  glm::dvec3 eye{0.0, 0.0, 1.0};
  glm::dvec3 look_at{0.0};
  glm::dvec3 up{0.0, 1.0, 0.0};
  double fov_degrees = 45;
  double hither = 0;
  int width = 512;
  int height = 512;
  friend bool operator==(const Camera&, const Camera&) = default;
};

}  // namespace raymeter
