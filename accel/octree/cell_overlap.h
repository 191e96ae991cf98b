#pragma once

#include <glm/vec3.hpp>

#include "core/scene/pools.h"

namespace raymeter {

/// Whether a primitive may touch a closed box, all its surface considered and not only its own box: never false where it does. Decided by separating axes:
/// a triangle exactly, but for touching within a rounding; a sphere's surface by its least and greatest distance; a polygon by its plane, for its kernel may
/// find a point anywhere in the plane and the polygon's box; a cone's surface by axes and lateral planes, boxes wholly inside it left out. The caller has
/// made sure that the primitive's own box touches.
[[nodiscard]] bool may_touch(const Pools& pools, PrimRef prim, const glm::dvec3& center, const glm::dvec3& half) noexcept;

}  // namespace raymeter
