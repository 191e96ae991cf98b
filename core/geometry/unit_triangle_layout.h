#pragma once

#include <cstdint>

namespace raymeter {

/// Pointers into UnitTriangles (core/scene/unit_triangles.h).
struct UnitTriangleView {
  const float* map;
  const std::int8_t* axis;
};

}  // namespace raymeter
