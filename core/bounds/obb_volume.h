#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include <glm/vec3.hpp>

#include "core/bounds/bounding_volume.h"

namespace raymeter {

/// All x with |axis[i] . (x - center)| <= half[i]. The axes are unit and perpendicular up to rounding; as stored they are exactly what the volume means.
struct Obb {
  glm::vec3 center{0.0f};
  std::array<glm::vec3, 3> axis{glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)};
  glm::vec3 half{0.0f};
};

/// Which way oriented boxes face: as the space in which the composite object was made (world axes where it has none), along the principal components of what
/// they hold (Gottschalk et al. 1996), or the one of least area among these, the world's axes, and those of single triangles and cones inside.
enum class ObbAxes : std::uint8_t { object, pca, best };

/// Oriented bounding boxes.
struct ObbVolume {
  using Bound = Obb;
  using Layout = ObbLayout;
  static constexpr bool kMergeIsTight = false;
  ObbAxes axes = ObbAxes::best;

  [[nodiscard]] Obb fit(const Scene& scene, PrimRef prim) const { return fit(scene, {&prim, 1}); }
  [[nodiscard]] Obb fit(const Scene& scene, std::span<const PrimRef> prims) const;
  /// Along the axes of a, of b or of the world, whichever gives the least area.
  [[nodiscard]] Obb merge(const Obb& a, const Obb& b) const noexcept;
  [[nodiscard]] double half_area(const Obb& box) const noexcept;
  [[nodiscard]] double enclosed(const Obb& box) const noexcept;

  [[nodiscard]] std::int32_t floats() const noexcept { return Layout::kFloats; }
  [[nodiscard]] Layout::Shared shared(std::span<const Obb>) const noexcept { return {}; }
  void write(const Obb& box, float* data) const noexcept;
};
static_assert(BoundingVolume<ObbVolume>);

}  // namespace raymeter
