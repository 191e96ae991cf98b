#pragma once

#include "core/bounds/slab_kernel.h"

namespace raymeter {

/// The interval of a walk from cell to cell through a box: that of the ray, or, with `from_origin`, from the ray's origin on even where its interval begins
/// later, as programs walk that only leave out near hits. Rays meet the box where t_near <= t_far.
template <class L, bool kUniform>
[[gnu::always_inline]] inline SlabInterval<L> way_through(const RayPacket<L>& ray, typename L::Float t_end, const BoxPlanes<L, kUniform>& planes,
                                                          bool from_origin) noexcept {
  using Float = typename L::Float;
  const SlabInterval<L> line = line_in_box(ray, planes);
  const Float begin = from_origin ? L::min(ray.t_min, Float(0.0f)) : ray.t_min;
  return {L::max(line.t_near, begin), L::min(line.t_far, t_end)};
}

}  // namespace raymeter
