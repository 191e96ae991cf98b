#pragma once

#include <cstdint>

#include "core/base/column.h"
#include "core/geometry/unit_triangle_layout.h"

namespace raymeter {

struct Pools;

/// The affine maps that take triangles to the unit triangle (Baldwin, Weber 2016, JCGT 5(3)). The third axis there is the one of space along which the normal
/// is longest, so that of a map's 12 numbers 9 are not 0 or 1; offsets are in absolute coordinates, and cancel far from the origin.
struct UnitTriangles {
  Column<float> map;         ///< nine a triangle: with (p, q) the point's coordinates on the axes that follow `axis` cyclically, and r the one on it,
                             ///< u = m0 p + m1 q + m2, v = m3 p + m4 q + m5, height above the plane = r + m6 p + m7 q + m8. NaN of triangles without area.
  Column<std::int8_t> axis;  ///< 0, 1, 2
  [[nodiscard]] UnitTriangleView view() const noexcept { return {map.data(), axis.data()}; }
  [[nodiscard]] std::size_t mem_bytes() const noexcept;
};

/// Those of all triangles of the pools, in their order, computed in double.
[[nodiscard]] UnitTriangles unit_triangles(const Pools& pools, int threads);

}  // namespace raymeter
