#pragma once

// Rays against bounding slabs: t = (d - N . org) / (N . dir), with N . org and the reciprocals made once and shared by all volumes (Kay, Kajiya 1986).
//
// No false misses, u = kUnitRoundoff, |.|_1 sums of magnitudes, org measured from the slabs' common origin. Of a hit P at t, N . P is within
// 32 u |N| |P - org| of the slab (kSurfaceError), and |P - org| <= |t| |dir|_1. That, and the error of N . dir, 4 u |N| |dir|_1, grow with t and so are taken
// as a tilt of the slab's planes: kappa = 48 u |N| |dir|_1, of which the rest is for the five roundings of t, with one division for two reciprocals. For t >= 0
// the plane that is met first has the slope |N . dir| + kappa then, the one that is left |N . dir| - kappa; for t < 0 it would be the other way round:
// 3 kappa |t_min| more room covers it where t_min < 0. N . org is wrong by 5 u |N| |org|_1, its product with the reciprocal by 2 u |N| |org|_1 more, and that
// of the plane by u |N| radius, within which all planes lie: room for 9 u |N| |org|_1 + 2 u |N| radius. Nearly parallel, |N . dir| <= 2 kappa: the plane that
// is left says nothing of t but that the ray is below it, up to what slope and tilt amount to on the way through all that can be hit: 3 kappa |P - org| /
// |dir|, with |P - org| <= |org|_1 + radius and |dir|_1 <= 1.8 |dir| less than 260 u |N| (|org|_1 + radius). It gets room for 400, so that what is left over
// 2^-20 kappa is beyond any such P.

#include "core/bounds/volume_test_kernel.h"

namespace raymeter {

template <class L>
struct VolumeRays<KdopLayout, L> {
  using Float = typename L::Float;
  static constexpr bool kSigned = false;
  /// A lone ray's planes are picked in the order in which it meets them, which saves the comparisons.
  static constexpr bool kOrdered = L::kWidth == 1;
  // Slab i's least plane d is met at d * inverse[0][i] + offset[0][i], its greatest likewise by [1]; kOrdered: the one that is met first, and the other.
  Float inverse[2][KdopLayout::kMaxSlabs];
  Float offset[2][KdopLayout::kMaxSlabs];
  std::int32_t first[KdopLayout::kMaxSlabs];  ///< kOrdered: 1 where the greatest plane is met first, else 0

  void prepare(const KdopLayout::Shared& slabs, const RayPacket<L>& ray) noexcept {
    const Float zero(0.0f), one(1.0f);
    const Float org[3] = {ray.org[0] - Float(slabs.origin[0]), ray.org[1] - Float(slabs.origin[1]), ray.org[2] - Float(slabs.origin[2])};
    const Float org1 = L::abs(org[0]) + L::abs(org[1]) + L::abs(org[2]);
    const Float tilt = Float(48 * kUnitRoundoff) * (L::abs(ray.dir[0]) + L::abs(ray.dir[1]) + L::abs(ray.dir[2]));
    const Float behind = L::max(-ray.t_min, zero);
    const Float radius(slabs.radius);
    const Float room = L::mul_add(Float(9 * kUnitRoundoff), org1, L::mul_add(Float(2 * kUnitRoundoff), radius, Float(3.0f) * tilt * behind));
    const Float room_parallel = Float(400 * kUnitRoundoff) * (org1 + radius);
    for (std::int32_t i = 0; i < slabs.count; ++i) {
      const Float x(slabs.direction[i][0]), y(slabs.direction[i][1]), z(slabs.direction[i][2]), length(slabs.length[i]);
      const Float height = L::mul_add(org[2], z, L::mul_add(org[1], y, org[0] * x));
      const Float slope = L::mul_add(ray.dir[2], z, L::mul_add(ray.dir[1], y, ray.dir[0] * x));
      const Float kappa = tilt * length, steepness = L::abs(slope);
      const auto parallel = steepness <= kappa + kappa;
      const Float slack = length * (room + L::select(parallel, room_parallel, zero));
      const Float first_slope = steepness + kappa;
      const Float last_slope = L::select(parallel, kappa * Float(0x1p-20f), steepness - kappa);
      const Float product = one / (first_slope * last_slope);
      const Float first_inverse = last_slope * product, last_inverse = first_slope * product;
      const auto down = slope < zero;  // and so the greatest plane is met first
      if constexpr (kOrdered) {
        const Float above = L::select(down, -height, height);
        first[i] = L::any(down) ? 1 : 0;
        inverse[0][i] = L::select(down, -first_inverse, first_inverse);
        inverse[1][i] = L::select(down, -last_inverse, last_inverse);
        offset[0][i] = -(above + slack) * first_inverse;
        offset[1][i] = (slack - above) * last_inverse;
      } else {
        inverse[0][i] = L::select(down, -last_inverse, first_inverse);
        inverse[1][i] = L::select(down, -first_inverse, last_inverse);
        offset[0][i] = -(height + slack) * inverse[0][i];
        offset[1][i] = (slack - height) * inverse[1][i];
      }
    }
  }
};

template <class L, bool kUniform>
struct VolumeTest<KdopLayout, L, kUniform> {
  using Float = typename L::Float;
  const float* planes;
  std::int32_t count;

  [[gnu::always_inline]] VolumeTest(const KdopLayout::Shared& slabs, const float* data, std::int32_t) noexcept : planes(data), count(slabs.count) {}

  [[nodiscard]] [[gnu::always_inline]] SlabInterval<L> line(const RayPacket<L>&, const VolumeRays<KdopLayout, L>& rays) const noexcept {
    Float t_near(-kInfinity), t_far(kInfinity);
    for (std::int32_t i = 0; i < count; ++i) {
      const std::int32_t first = VolumeRays<KdopLayout, L>::kOrdered ? rays.first[i] : 0;
      const Float t_first = L::mul_add(Float(planes[2 * i + first]), rays.inverse[0][i], rays.offset[0][i]);
      const Float t_last = L::mul_add(Float(planes[2 * i + 1 - first]), rays.inverse[1][i], rays.offset[1][i]);
      if constexpr (VolumeRays<KdopLayout, L>::kOrdered) {
        t_near = L::max(t_first, t_near);
        t_far = L::min(t_last, t_far);
      } else {
        t_near = L::max(L::min(t_first, t_last), t_near);
        t_far = L::min(L::max(t_first, t_last), t_far);
      }
    }
    return {t_near, t_far};
  }
};

}  // namespace raymeter
