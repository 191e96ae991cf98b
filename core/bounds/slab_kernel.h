#pragma once

// Rays against an axis-aligned box, with no false misses. Subtract, then multiply; near and far planes by the sign bit of the direction; reciprocals of zero
// stay infinite and 0 * inf = NaN falls through min and max (a ray in a face plane is inside, the box is closed). The interval grows by kSlabPadding relative
// to its ends (Ize 2013, JCGT 2(2)), and more than rounding asks for: by what the primitive kernels may err (error_bounds.h).

#include "core/geometry/error_bounds.h"
#include "core/ray/ray_packet.h"

namespace raymeter {

/// Where rays are inside a box: t_near <= t_far where they meet it; else the two mean nothing.
template <class L>
struct SlabInterval {
  typename L::Float t_near;
  typename L::Float t_far;
};

/// A box in registers, the same in all lanes: its planes of least and greatest coordinate, or, where all rays share their direction signs (kUniform), the
/// planes that they meet first and last.
template <class L, bool kUniform>
struct BoxPlanes {
  typename L::Float first[3];
  typename L::Float last[3];

  /// `box` is min x y z, max x y z. `octant` matters only if kUniform: the sign bits of the directions.
  BoxPlanes(const float* box, std::int32_t octant) noexcept {
    for (int a = 0; a < 3; ++a) {
      const int swapped = kUniform && (octant >> a & 1) != 0 ? 3 : 0;
      first[a] = typename L::Float(box[a + swapped]);
      last[a] = typename L::Float(box[a + 3 - swapped]);
    }
  }
};

/// Where the whole line is between a box's planes, with scales of each axis for the way to the planes that it meets first and last: 1 / dir, grown or not.
template <class L, bool kUniform>
[[gnu::always_inline]] inline SlabInterval<L> line_between_planes(const RayPacket<L>& ray, const BoxPlanes<L, kUniform>& planes,
                                                                  const typename L::Float (&near_scale)[3], const typename L::Float (&far_scale)[3]) noexcept {
  using Float = typename L::Float;
  Float t_near(-kInfinity), t_far(kInfinity);
  for (int a = 0; a < 3; ++a) {
    const Float near_plane = kUniform ? planes.first[a] : L::select(ray.negative[a], planes.last[a], planes.first[a]);
    const Float far_plane = kUniform ? planes.last[a] : L::select(ray.negative[a], planes.first[a], planes.last[a]);
    t_near = L::max((near_plane - ray.org[a]) * near_scale[a], t_near);
    t_far = L::min((far_plane - ray.org[a]) * far_scale[a], t_far);
  }
  return {t_near, t_far};
}

/// The whole line's interval in the box, not clipped to the ray's.
template <class L, bool kUniform>
[[gnu::always_inline]] inline SlabInterval<L> line_in_box(const RayPacket<L>& ray, const BoxPlanes<L, kUniform>& planes) noexcept {
  using Float = typename L::Float;
  const auto [t_near, t_far] = line_between_planes(ray, planes, ray.inv_dir, ray.inv_dir);
  return {L::mul_add(t_near, Float(1.0f - kSlabPadding), -ray.slab_slack), L::mul_add(t_far, Float(1.0f + kSlabPadding), ray.slab_slack)};
}

/// Where the line is inside a primitive's own box, for kernels that clamp t to it (kOwnBoxPadding in error_bounds.h); t may have either sign.
/// low and high: the box minus the origin, grown.
template <class L>
inline SlabInterval<L> line_in_own_box(const RayPacket<L>& ray, const typename L::Float (&low)[3], const typename L::Float (&high)[3]) noexcept {
  using Float = typename L::Float;
  Float t_near(-kInfinity), t_far(kInfinity);
  for (int a = 0; a < 3; ++a) {
    t_near = L::max(L::select(ray.negative[a], high[a], low[a]) * ray.inv_dir[a], t_near);
    t_far = L::min(L::select(ray.negative[a], low[a], high[a]) * ray.inv_dir[a], t_far);
  }
  const Float padding(kOwnSlabPadding);
  return {L::neg_mul_add(padding, L::abs(t_near), t_near), L::mul_add(padding, L::abs(t_far), t_far)};
}

/// The same for box i of columns that hold tight boxes.
template <class L>
inline SlabInterval<L> line_in_own_box(const RayPacket<L>& ray, const float* const* box_min, const float* const* box_max, std::int32_t i) noexcept {
  using Float = typename L::Float;
  float extent = 0;
  for (int a = 0; a < 3; ++a) extent = box_max[a][i] - box_min[a][i] > extent ? box_max[a][i] - box_min[a][i] : extent;
  // Added after the origin has been subtracted: far from the world's origin the box itself has no room for so little.
  const Float padding(kOwnBoxPadding * extent);
  Float low[3], high[3];
  for (int a = 0; a < 3; ++a) {
    low[a] = Float(box_min[a][i]) - ray.org[a] - padding;
    high[a] = Float(box_max[a][i]) - ray.org[a] + padding;
  }
  return line_in_own_box<L>(ray, low, high);
}

/// The interval clipped to [t_min, t_end]: rays meet the box where t_near <= t_far.
template <class L, bool kUniform>
[[gnu::always_inline]] inline SlabInterval<L> intersect_box(const RayPacket<L>& ray, typename L::Float t_end, const BoxPlanes<L, kUniform>& planes) noexcept {
  const SlabInterval<L> line = line_in_box(ray, planes);
  return {L::max(line.t_near, ray.t_min), L::min(line.t_far, t_end)};
}

}  // namespace raymeter
