#pragma once

#include <array>
#include <cstdint>

#include <glm/vec3.hpp>

#include "core/bounds/aabb.h"
#include "core/scene/pools.h"

namespace raymeter {

/// Whether a primitive may touch a closed box, all its surface considered and not only its own box: never false where it does. Decided by separating axes:
/// a triangle exactly, but for touching within a rounding; a sphere's surface by its least and greatest distance; a polygon by its plane, for its kernel may
/// find a point anywhere in the plane and the polygon's box; a cone's surface by axes and lateral planes, boxes wholly inside it left out. The caller has
/// made sure that the primitive's own box touches.
[[nodiscard]] bool may_touch(const Pools& pools, PrimRef prim, const glm::dvec3& center, const glm::dvec3& half) noexcept;

/// A box for may_touch().
struct CellBox {
  glm::dvec3 center;
  glm::dvec3 half;
};

/// A cell cut into eight; a child's number has a bit for each axis, set where it lies above the plane.
struct DividedCell {
  Aabb box;
  glm::vec3 split;
  std::array<CellBox, 8> child;  ///< with a margin that lists have to reach beyond
};

/// Those of the children named by the bits of `of` that the primitive may touch: may_touch() of each. What this needs of the primitive is found once, and a
/// child that holds a triangle's corner is not asked for.
[[nodiscard]] std::uint8_t touched(const Pools& pools, PrimRef prim, const DividedCell& cell, std::uint8_t of) noexcept;

}  // namespace raymeter
