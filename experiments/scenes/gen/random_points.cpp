#include "experiments/scenes/gen/random_points.h"

#include <cmath>

#include <glm/geometric.hpp>

namespace raymeter {

glm::dvec3 uniform_in_cube(RandomStream& random, double min, double max) noexcept {
  glm::dvec3 point;
  // One statement a coordinate: the order in which arguments are evaluated is the compiler's choice.
  for (glm::length_t axis = 0; axis < 3; ++axis) point[axis] = min + (max - min) * random.uniform();
  return point;
}

glm::dvec3 uniform_direction(RandomStream& random) noexcept {
  for (;;) {  // by rejection of what is outside the ball, or too near to its centre to be divided well
    const glm::dvec3 point = uniform_in_cube(random, -1, 1);
    const double square = glm::dot(point, point);
    if (square <= 1 && square > 1e-4) return point / std::sqrt(square);
  }
}

}  // namespace raymeter
