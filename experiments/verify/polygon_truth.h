#pragma once

#include <vector>

#include "core/scene/pools.h"
#include "experiments/verify/true_hits.h"

namespace raymeter::verify {

/// A polygon, which after the rounding of its vertices need not be planar. What it means: a line passes through it where it passes through the outline as seen
/// along the line (crossing parity, the outline included); it meets it where it meets the plane through vertex 0 with the stored normal, but inside the
/// vertices' bounding box.
struct PolygonShape {
  std::vector<std::array<float, 3>> vertex;
  float normal[3];
};
[[nodiscard]] PolygonShape polygon_at(const Pools& pools, std::size_t i);

/// A line along which the outline is seen edge-on misses.
[[nodiscard]] TrueHits true_hits(const Ray& ray, const PolygonShape& polygon, Arithmetic arithmetic = Arithmetic::filtered);
/// t of the plane, moved into the bounding box; for a ray just beside the outline too.
[[nodiscard]] double depth(const PolygonShape& polygon, const Point& org, const Point& dir) noexcept;
/// For a ray that passes through the outline: how far org + t dir is from the plane, or from the box where the box cuts the plane off.
[[nodiscard]] double distance(const PolygonShape& polygon, const Point& org, const Point& dir, double t) noexcept;

}  // namespace raymeter::verify
