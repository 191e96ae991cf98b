#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/scene/pools.h"

namespace raymeter {

/// Triangles that cover a pool's polygons, for a renderer that knows no others. Of a simple polygon of n vertices n - 2,
/// which use all of them, those on straight edges too; none of one without an area.
struct PolygonTriangles {
  std::vector<std::array<std::uint32_t, 3>> vertex;  ///< places in the pool's vertex columns, in the polygon's order of turning
  std::vector<std::int32_t> polygon;                 ///< whose triangle it is: place in the pool
};

/// By cutting off ears (Meisters 1975), seen along each polygon's normal; up to n^3 steps a polygon, n^2 where it is convex. Exactly the polygon where its
/// outline is simple; an outline that crosses itself gives triangles near it.
[[nodiscard]] PolygonTriangles triangles_of(const PolygonPool& pool);

}  // namespace raymeter
