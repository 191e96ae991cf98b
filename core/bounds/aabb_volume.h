#pragma once

#include "core/bounds/aabb.h"
#include "core/bounds/bounding_volume.h"

namespace raymeter {

/// Axis-aligned boxes, padded.
struct AabbVolume {
  using Bound = Aabb;

  [[nodiscard]] Aabb fit(const Scene& scene, PrimRef prim) const noexcept { return padded_bounds(scene.pools(), prim); }
  [[nodiscard]] Aabb fit(const Scene& scene, std::span<const PrimRef> prims) const noexcept {
    Aabb box;
    for (const PrimRef prim : prims) box.grow(fit(scene, prim));
    return box;
  }
  [[nodiscard]] Aabb merge(const Aabb& a, const Aabb& b) const noexcept {
    Aabb box = a;
    box.grow(b);
    return box;
  }
  [[nodiscard]] double half_area(const Aabb& box) const noexcept {
    if (box.empty()) return 0;
    const glm::dvec3 e = glm::dvec3(box.max) - glm::dvec3(box.min);
    return e.x * e.y + e.y * e.z + e.z * e.x;
  }
};
static_assert(BoundingVolume<AabbVolume>);

}  // namespace raymeter
