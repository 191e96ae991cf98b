#pragma once

#include <array>

#include <glm/vec3.hpp>

#include "core/bounds/aabb.h"

namespace raymeter {

/// What bounding volumes other than boxes have to hold of a primitive: the convex hull of points and discs, grown by `margin` all round, in double. The margin
/// is the sphere's radius, the part of the kernels' errors that is relative to the primitive's size (kSurfaceError of the diagonal of its box), and room for
/// the roundings of the functions below.
struct PrimHull {
  struct Disc {
    glm::dvec3 center{0.0};
    glm::dvec3 normal{0.0};  ///< unit; zero where the disc may face anywhere
    double radius = 0;
  };
  std::array<glm::dvec3, 8> points{};
  int point_count = 0;
  std::array<Disc, 2> discs{};
  int disc_count = 0;
  double margin = 0;

  /// Greatest value of direction . (x - origin) over the hull; `direction` need not be a unit vector.
  [[nodiscard]] double reach(const glm::dvec3& direction, const glm::dvec3& origin) const noexcept;
  /// Distance from `from` to the hull's furthest point, which is stored in `furthest`.
  [[nodiscard]] double furthest(const glm::dvec3& from, glm::dvec3& furthest) const noexcept;
};

/// Of a polygon it is the box: at grazing incidence its kernel may find t anywhere in there.
[[nodiscard]] PrimHull prim_hull(const Pools& pools, PrimRef prim) noexcept;

/// Half the surface area of a primitive's convex hull: twice its mean projected area. Cones count with their lids; of concave polygons it is the own area.
[[nodiscard]] double hull_half_area(const Pools& pools, PrimRef prim) noexcept;

}  // namespace raymeter
