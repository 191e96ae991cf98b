#pragma once

#include <cstddef>

#include <glm/vec3.hpp>

#include "core/base/column.h"

namespace raymeter {

/// Radiance per pixel, rows from the top. NFF's colours are display values: 1 is white, nothing is gamma-corrected, more than 1 is kept.
struct Image {
  int width = 0;
  int height = 0;
  Column<glm::vec3> pixel;  ///< [y * width + x]
};

}  // namespace raymeter
