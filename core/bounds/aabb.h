#pragma once

#include <limits>

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include "core/scene/pools.h"

namespace raymeter {

/// Axis-aligned box; empty by default (min > max).
struct Aabb {
  glm::vec3 min{std::numeric_limits<float>::infinity()};
  glm::vec3 max{-std::numeric_limits<float>::infinity()};

  void grow(const glm::vec3& point) noexcept {
    min = glm::min(min, point);
    max = glm::max(max, point);
  }
  void grow(const Aabb& other) noexcept {
    min = glm::min(min, other.min);
    max = glm::max(max, other.max);
  }
  [[nodiscard]] bool empty() const noexcept { return !(min.x <= max.x); }
  [[nodiscard]] glm::vec3 extent() const noexcept { return max - min; }
  /// Twice the centre: comparable without a rounding from the halving.
  [[nodiscard]] glm::vec3 center2() const noexcept { return min + max; }
  [[nodiscard]] float half_area() const noexcept {
    if (empty()) return 0;
    const glm::vec3 e = extent();
    return e.x * e.y + e.y * e.z + e.z * e.x;
  }
};

/// Smallest float box around a primitive (true extents of spheres and cones, rounded outwards).
[[nodiscard]] Aabb tight_bounds(const Pools& pools, PrimRef ref) noexcept;
/// The box grown by kBoundsPadding of its largest extent, and on each axis at least of its largest |coordinate|: what structures are built from, so that
/// culling never loses a hit (error_bounds.h), even by cells whose borders are computed from coordinates.
[[nodiscard]] Aabb padded(const Aabb& box) noexcept;
[[nodiscard]] inline Aabb padded_bounds(const Pools& pools, PrimRef ref) noexcept { return padded(tight_bounds(pools, ref)); }

}  // namespace raymeter
