#pragma once

#include <glm/vec3.hpp>

#include "core/bounds/bounding_volume.h"

namespace raymeter {

struct BoundingSphere {
  glm::vec3 center{0.0f};
  float radius = 0;
};

/// Bounding spheres (Whitted 1980). The simple fit takes the centre of the box and the furthest point; the tight one moves the centre towards the furthest
/// point by ever smaller steps (Badoiu, Clarkson 2003: Smaller core-sets for balls), to within a percent of the smallest ball.
struct SphereVolume {
  using Bound = BoundingSphere;
  using Layout = SphereLayout;
  static constexpr bool kMergeIsTight = false;
  bool tight = false;

  [[nodiscard]] BoundingSphere fit(const Scene& scene, PrimRef prim) const { return fit(scene, {&prim, 1}); }
  [[nodiscard]] BoundingSphere fit(const Scene& scene, std::span<const PrimRef> prims) const;
  [[nodiscard]] BoundingSphere merge(const BoundingSphere& a, const BoundingSphere& b) const noexcept;
  [[nodiscard]] double half_area(const BoundingSphere& sphere) const noexcept;
  [[nodiscard]] double enclosed(const BoundingSphere& sphere) const noexcept;

  [[nodiscard]] std::int32_t floats() const noexcept { return Layout::kFloats; }
  [[nodiscard]] Layout::Shared shared(std::span<const BoundingSphere>) const noexcept { return {}; }
  void write(const BoundingSphere& sphere, float* data) const noexcept;
};
static_assert(BoundingVolume<SphereVolume>);

}  // namespace raymeter
