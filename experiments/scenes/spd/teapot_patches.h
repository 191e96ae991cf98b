#pragma once

#include <array>
#include <cstdint>

#include <glm/vec3.hpp>

namespace raymeter {

/// The 32 bicubic Bezier patches of the classic teapot: indices of 4 x 4 control points, row by row. Rim 4, body 8, handle 4, spout 4, lid 8, bottom 4.
extern const std::array<std::array<std::uint16_t, 16>, 32> kTeapotPatches;
/// Its control points; z is up, the bottom lies at 0, the top of the lid at 3.15.
extern const std::array<glm::dvec3, 290> kTeapotPoints;

}  // namespace raymeter
