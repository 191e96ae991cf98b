#pragma once

#include <span>

#include "accel/bvh/binned_splits.h"
#include "core/scene/scene.h"

namespace raymeter {

/// Bins of equal width over a node's box, on all axes. An axis that is too thin for them has none.
struct SpatialMapping {
  int bins;
  Box4 box;
  Row4 width;
  Row4 scale;  ///< 0: no bins
  SpatialMapping(const Box4& node, int bin_count) noexcept;
  [[nodiscard]] bool usable(int axis) const noexcept { return scale[axis] > 0; }
  [[nodiscard]] int bin(float x, int axis) const noexcept {
    const auto b = static_cast<int>((x - box.min[axis]) * scale[axis]);
    return b < 0 ? 0 : b < bins ? b : bins - 1;
  }
  /// Where bin b begins.
  [[nodiscard]] float border(int b, int axis) const noexcept { return box.min[axis] + width[axis] * static_cast<float>(b); }
};

/// Counts each reference, with its part's box, in every bin that it reaches into. The parts are cut in float, without room for its roundings: good enough to
/// weigh splits; what a split really leaves, cut() says.
void bin_parts(const Scene& scene, std::span<const BinnedBox> references, const SpatialMapping& mapping, Bins& bins);

}  // namespace raymeter
