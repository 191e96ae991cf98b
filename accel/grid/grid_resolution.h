#pragma once

#include <array>
#include <cstdint>

#include <glm/vec3.hpp>

#include "accel/grid/grid.h"
#include "core/bounds/aabb.h"

namespace raymeter {

using GridResolution = std::array<std::int32_t, 3>;

/// Cells on each axis for `prim_count` primitives N in a box of the given extent, with density D:
///   cubic      cells as near to cubes as whole numbers allow, about D N of them; axes too short for a whole cell get one
///   woo        int(extent / largest extent * (D N)^(1/3)), as Havran and Sixta 1999 state Woo's rule
///   customary  int(D N^(1/3)) on every axis
/// At least 1 and at most max_resolution. An explicit resolution is taken as it is; throws Error where it cannot be read.
[[nodiscard]] GridResolution grid_resolution(const GridParams& params, const glm::dvec3& extent, std::int64_t prim_count);

/// The least size of a cell along axis a of the scene's box: a primitive's padding is not to fill several cells.
[[nodiscard]] double finest_cell(const Aabb& box, glm::length_t a) noexcept;
/// Cells along axis a that single precision can tell apart, at most; 1 where the extent is beyond float's range.
[[nodiscard]] std::int32_t useful_resolution(const Aabb& box, glm::length_t a) noexcept;

}  // namespace raymeter
