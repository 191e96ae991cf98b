#pragma once

#include <vector>

#include <glm/vec3.hpp>

#include "core/bounds/aabb.h"
#include "core/scene/scene.h"

namespace raymeter {

/// Area of a primitive's surface; cones are open.
[[nodiscard]] double surface_area(const Pools& pools, PrimRef ref) noexcept;

/// The vertices of a triangle or polygon.
[[nodiscard]] std::vector<glm::dvec3> outline(const Pools& pools, PrimRef ref);

/// Area of the part of a planar outline, concave ones included, that lies in the box.
[[nodiscard]] double area_in_box(const std::vector<glm::dvec3>& outline, const Aabb& box);

/// A point of the surface for u, v uniform in [0, 1): uniform in area. Not of polygons.
[[nodiscard]] glm::dvec3 point_on_surface(const Pools& pools, PrimRef ref, double u, double v) noexcept;

}  // namespace raymeter
