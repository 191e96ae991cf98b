#include "accel/ray_classification/ray_space.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/error_bounds.h"

namespace raymeter {

namespace {

/// Rays that start further from the scene than this, in its largest extents, are not classified: the rounding of where they enter it would swell every beam.
constexpr double kReachExtents = 8;
/// What beams are grown by, in roundings of way and coordinates: 32 for the primitive kernels (kSurfaceError), 80 for what classification loses.
constexpr double kBeamError = 112 * double{kUnitRoundoff};
/// The least width of a cell, in paddings: of thinner ones most would be padding.
constexpr double kLeastWidth = 4;

/// How often an extent can be halved.
int useful_bits(double extent, double padding, int wanted) noexcept {
  if (!(extent > kLeastWidth * padding)) return 0;
  return std::min(wanted, static_cast<int>(std::log2(extent / (kLeastWidth * padding))));
}

}  // namespace

RaySpace::RaySpace(const Aabb& box, const RayClassificationParams& params) {
  std::array<double, 3> extent{};
  double largest = 0, coordinate = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<glm::length_t>(a);
    frame_.box[a] = box.min[axis];
    frame_.box[a + 3] = box.max[axis];
    if (box.empty()) continue;
    low_[a] = double{box.min[axis]};
    extent[a] = double{box.max[axis]} - double{box.min[axis]};
    largest = std::max(largest, extent[a]);
    coordinate = std::max({coordinate, std::abs(double{box.min[axis]}), std::abs(double{box.max[axis]})});
  }
  const double reach = (kReachExtents + 0.5) * largest;
  padding_ = kBeamError * (std::sqrt(3.0) * (reach + largest) + coordinate);
  frame_.most_slack = static_cast<float>(std::min(2 * double{kSlabPadding} * (reach + largest), 0x1p120));
  // Beyond that neither the lengths nor their reciprocals would be floats.
  const bool divisible = largest < 0x1p100 && padding_ > 0x1p-100;
  for (std::size_t a = 0; a < 3; ++a) {
    frame_.center[a] = static_cast<float>(low_[a] + extent[a] / 2);
    frame_.reach[a] = static_cast<float>(std::min(reach, 0x1p120));
    bits_[a] = divisible ? useful_bits(extent[a], padding_, params.position_bits) : 0;
    frame_.cells_per_unit[a] = bits_[a] > 0 ? static_cast<float>(std::ldexp(1 / extent[a], bits_[a])) : 0.0f;
    frame_.last_cell[a] = static_cast<float>((1 << bits_[a]) - 1);
    length_[a] = bits_[a] > 0 ? std::ldexp(1 / double{frame_.cells_per_unit[a]}, bits_[a]) : extent[a];
  }
  bits_[3] = divisible ? params.direction_bits : 0;
  low_[3] = -1;
  length_[3] = 2;
  frame_.slope_cells = static_cast<float>(std::ldexp(0.5, bits_[3]));
  frame_.last_slope = static_cast<float>((1 << bits_[3]) - 1);
  for (std::int32_t c = 0; c < kRayClasses; ++c) {
    choose_splits(c, extent, params);
    frame_.key_bits = std::max(frame_.key_bits, depth(c));
  }
  fill_spread();
}

/// The axis whose cells are widest is halved next: by how much its width spreads the beam, half the scene's depth ahead. In turn: all are taken for equally
/// wide.
void RaySpace::choose_splits(std::int32_t ray_class, const std::array<double, 3>& extent, const RayClassificationParams& params) {
  const double ahead = extent[static_cast<std::size_t>(world_axis(ray_class, 2))] / 2;
  std::array<double, kRayAxes> width{};
  std::array<int, kRayAxes> left{};
  for (int axis = 0; axis < kRayAxes; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const auto world = axis < 3 ? static_cast<std::size_t>(world_axis(ray_class, axis)) : std::size_t{3};
    left[a] = bits_[world];
    width[a] = params.split == "cycle" ? 1 : axis < 2 ? extent[world] : axis == 2 ? extent[world] / 2 : 2 * ahead;
  }
  std::vector<std::uint8_t>& order = split_axis_[static_cast<std::size_t>(ray_class)];
  while (static_cast<int>(order.size()) < params.max_depth) {
    std::size_t widest = kRayAxes;
    for (std::size_t a = 0; a < kRayAxes; ++a) {
      if (left[a] > 0 && (widest == kRayAxes || width[a] > width[widest])) widest = a;
    }
    if (widest == kRayAxes) return;
    order.push_back(static_cast<std::uint8_t>(widest));
    width[widest] /= 2;
    --left[widest];
  }
}

/// Which bits of a key a coordinate's bits become: the highest goes where its axis is split first. Bits beyond the last split become none.
void RaySpace::fill_spread() {
  spread_.resize(static_cast<std::size_t>(kRayClasses * kRayAxes * 2) << kHalfBits);
  for (std::int32_t c = 0; c < kRayClasses; ++c) {
    std::array<int, kRayAxes> used{};
    for (int d = 0; d < depth(c); ++d) {
      const int axis = split_axis(c, d);
      const int world = axis < 3 ? world_axis(c, axis) : 3;
      const int bit = bits_[static_cast<std::size_t>(world)] - 1 - used[static_cast<std::size_t>(axis)]++;
      const int half = bit / kHalfBits;
      std::uint64_t* const table = spread_.data() + (static_cast<std::size_t>((c * kRayAxes + axis) * 2 + half) << kHalfBits);
      for (std::size_t value = 0; value < std::size_t{1} << kHalfBits; ++value) {
        if ((value >> (bit % kHalfBits) & 1) != 0) table[value] |= std::uint64_t{1} << (frame_.key_bits - 1 - d);
      }
    }
  }
}

RayClassFrame RaySpace::frame() const noexcept {
  RayClassFrame frame = frame_;
  frame.spread = spread_.data();
  return frame;
}

double RaySpace::border(int axis, int splits, std::uint32_t index) const noexcept {
  const auto a = static_cast<std::size_t>(axis);
  return low_[a] + std::ldexp(length_[a] * index, -splits);
}

}  // namespace raymeter
