#pragma once

// What a kind of bounding volume gives to traversals; each kind specialises these in core/bounds/<volume>_kernel.h for its Layout
// (core/bounds/volume_layout.h). A test may not miss: where a primitive inside the volume accepts a hit at t, t is inside the interval
// (core/geometry/error_bounds.h). NaN at an end of the interval means that nothing is known of this end.

#include "core/bounds/slab_kernel.h"
#include "core/bounds/volume_layout.h"
#include "core/ray/ray_packet.h"

namespace raymeter {

/// What a register of rays brings to all tests, made once by prepare(const Layout::Shared&, const RayPacket<L>&).
/// kSigned: tests gain where all rays of a packet share their direction signs.
template <class Layout, class L>
struct VolumeRays;

/// One volume in registers: VolumeTest(const Layout::Shared&, const float* data, octant), octant meaning something only if kUniform; its
/// line(const RayPacket<L>&, const VolumeRays<Layout, L>&) gives where the whole lines are inside.
template <class Layout, class L, bool kUniform>
struct VolumeTest;

/// The interval clipped to [t_min, t_end]: rays meet the volume where t_near <= t_far.
template <class Layout, class L, bool kUniform>
[[gnu::always_inline]] inline SlabInterval<L> intersect_volume(const RayPacket<L>& ray, const VolumeRays<Layout, L>& rays, typename L::Float t_end,
                                                               const VolumeTest<Layout, L, kUniform>& volume) noexcept {
  const SlabInterval<L> line = volume.line(ray, rays);
  return {L::max(line.t_near, ray.t_min), L::min(line.t_far, t_end)};
}

}  // namespace raymeter
