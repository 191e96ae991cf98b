#pragma once

#include <cmath>
#include <cstddef>

#include <glm/vec3.hpp>

namespace raymeter {

/// The colour of a light that an NFF file gives none: all such lights are equal, and the sum of their squares does not depend on how many there are.
[[nodiscard]] inline glm::dvec3 default_light_color(std::size_t light_count) noexcept { return glm::dvec3(1.0 / std::sqrt(static_cast<double>(light_count))); }

}  // namespace raymeter
