#include "accel/ray_classification/beam.h"

#include <algorithm>
#include <limits>

#include "core/bounds/prim_hull.h"

namespace raymeter {

namespace {

struct Interval {
  double low;
  double high;
};

constexpr std::uint32_t kStart = 1u << 4;

}  // namespace

Beam::Beam(const RaySpace& space, const CellAddress& cell) : forward_((cell.ray_class & 1) != 0 ? -1.0 : 1.0) {
  std::array<int, kRayAxes> splits{};
  for (int d = 0; d < cell.depth; ++d) ++splits[static_cast<std::size_t>(space.split_axis(cell.ray_class, d))];
  std::array<Interval, kRayAxes> part{};
  for (int axis = 0; axis < kRayAxes; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const int of = axis < 3 ? RaySpace::world_axis(cell.ray_class, axis) : 3;
    part[a] = {space.border(of, splits[a], cell.index[a]), space.border(of, splits[a], cell.index[a] + 1u)};
    if (axis < 3) world_[a] = of;
  }
  const Interval z = forward_ > 0 ? part[2] : Interval{-part[2].high, -part[2].low};
  const double padding = space.padding();
  start_ = z.low - padding;
  for (std::size_t a = 0; a < 2; ++a) {
    const Interval p = part[a], slope = part[3 + a];
    constexpr double kNone = std::numeric_limits<double>::infinity();
    // The line from the corner of the starts from which the steepest ray gets furthest out.
    const double high_from = slope.high >= 0 ? z.low : z.high, low_from = slope.low <= 0 ? z.low : z.high;
    const double high_padding = padding * (1 + std::abs(slope.high)), low_padding = padding * (1 + std::abs(slope.low));
    sides_[2 * a] = {1, slope.high, p.high - slope.high * high_from + high_padding, slope.high <= 0 ? p.high + padding : kNone};
    sides_[2 * a + 1] = {-1, slope.low, slope.low * low_from - p.low + low_padding, slope.low >= 0 ? padding - p.low : kNone};
  }
}

std::uint32_t Beam::planes_changed(int axis, int side) noexcept {
  if (axis == 2) return kAllPlanes;
  return 1u << (2 * (axis % 3) + side);
}

bool Beam::meets(std::uint32_t planes, const Aabb& box) const noexcept {
  const double low_z = forward_ * double{forward_ > 0 ? box.min[world_[2]] : box.max[world_[2]]};
  const double high_z = forward_ * double{forward_ > 0 ? box.max[world_[2]] : box.min[world_[2]]};
  if ((planes & kStart) != 0 && high_z < start_) return false;
  for (std::size_t k = 0; k < sides_.size(); ++k) {
    if ((planes >> k & 1) == 0) continue;
    const Side& side = sides_[k];
    const glm::length_t axis = world_[k / 2];
    const double inner = side.sign > 0 ? double{box.min[axis]} : -double{box.max[axis]};
    const double slope = side.sign * side.slope;
    if (inner > side.upright || inner - slope * (slope > 0 ? high_z : low_z) > side.bound) return false;
  }
  return true;
}

bool Beam::meets(std::uint32_t planes, const Pools& pools, PrimRef prim) const noexcept {
  if (prim.kind() == PrimKind::polygon) return true;
  const PrimHull hull = prim_hull(pools, prim);
  for (std::size_t k = 0; k < sides_.size(); ++k) {
    if ((planes >> k & 1) == 0) continue;
    const Side& side = sides_[k];
    glm::dvec3 inwards(0.0);
    inwards[world_[k / 2]] = -side.sign;
    inwards[world_[2]] = side.sign * side.slope * forward_;
    if (-hull.reach(inwards, glm::dvec3(0.0)) > side.bound) return false;
  }
  return true;
}

}  // namespace raymeter
