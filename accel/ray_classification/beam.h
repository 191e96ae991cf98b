#pragma once

#include <array>
#include <cstdint>

#include "accel/ray_classification/ray_space.h"
#include "core/scene/pools.h"

namespace raymeter {

/// Which of the five-dimensional cells of a class: its part of each axis.
struct CellAddress {
  std::array<std::uint16_t, kRayAxes> index{};
  std::uint8_t ray_class = 0;
  std::uint8_t depth = 0;
};

/// All points that the rays of a cell can reach. With p across and z along the class' direction, a ray that starts at (p0, z0) with slope m is at
/// p = p0 + m (z - z0), z >= z0; bounds of p0, z0 and m make four slanted planes, and four upright ones where no ray can turn outwards.
///
/// Padding. A hit that a primitive kernel accepts lies within kSurfaceError of its distance and of the primitive's size beside the primitive, and within
/// kPrimitiveError of its padded box (error_bounds.h); the ray's start and slopes are known to 80 roundings of way and coordinates (classify_kernel.cpp).
/// Planes are moved outwards by as much (RaySpace::padding), times one more than their slope: no primitive is left out that a ray of the cell can hit. Polygons
/// are held by their boxes alone: at grazing incidence their kernel may find t anywhere in there. Double precision adds nothing that counts.
class Beam {
public:
  /// `planes` is what changes_at() gives, or all.
  Beam(const RaySpace& space, const CellAddress& cell);

  static constexpr std::uint32_t kAllPlanes = 0x1F;
  /// The planes of a cell that are not its parent's, of which it is half `side` along `axis`.
  [[nodiscard]] static std::uint32_t planes_changed(int axis, int side) noexcept;

  /// Whether the primitive with this padded box may have a part on the inner side of each plane of the set.
  [[nodiscard]] bool meets(std::uint32_t planes, const Aabb& box) const noexcept;
  [[nodiscard]] bool meets(std::uint32_t planes, const Pools& pools, PrimRef prim) const noexcept;

private:
  /// sign * (p - slope * z) <= bound, and sign * p <= upright.
  struct Side {
    double sign;
    double slope;
    double bound;
    double upright;
  };
  std::array<Side, 4> sides_;  ///< axis 0 upper, lower, axis 1 upper, lower; bit k of a set of planes
  double start_;               ///< least z, bit 4
  std::array<glm::length_t, 3> world_;
  double forward_;  ///< z = forward * world coordinate
};

}  // namespace raymeter
