#pragma once

#include <algorithm>
#include <cmath>

#include "core/bounds/aabb.h"
#include "core/bounds/bounding_volume.h"

namespace raymeter {

/// Axis-aligned boxes, padded.
struct AabbVolume {
  using Bound = Aabb;
  using Layout = AabbLayout;
  static constexpr bool kMergeIsTight = true;

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
  [[nodiscard]] double enclosed(const Aabb& box) const noexcept {
    if (box.empty()) return 0;
    const glm::dvec3 e = glm::dvec3(box.max) - glm::dvec3(box.min);
    return e.x * e.y * e.z;
  }

  [[nodiscard]] std::int32_t floats() const noexcept { return Layout::kFloats; }
  [[nodiscard]] Layout::Shared shared(std::span<const Aabb> boxes) const noexcept {
    float reach = 0;
    for (const Aabb& box : boxes) {
      if (box.empty()) continue;
      for (glm::length_t a = 0; a < 3; ++a) reach = std::max({reach, std::abs(box.min[a]), std::abs(box.max[a])});
    }
    return {reach};
  }
  void write(const Aabb& box, float* data) const noexcept {
    for (glm::length_t a = 0; a < 3; ++a) {
      data[a] = box.min[a];
      data[a + 3] = box.max[a];
    }
  }
};
static_assert(BoundingVolume<AabbVolume>);

}  // namespace raymeter
