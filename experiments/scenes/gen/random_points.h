#pragma once

#include <glm/vec3.hpp>

#include "core/base/random.h"

namespace raymeter {

/// Uniform in the cube [min, max)^3.
[[nodiscard]] glm::dvec3 uniform_in_cube(RandomStream& random, double min, double max) noexcept;
/// Uniform on the unit sphere.
[[nodiscard]] glm::dvec3 uniform_direction(RandomStream& random) noexcept;

}  // namespace raymeter
