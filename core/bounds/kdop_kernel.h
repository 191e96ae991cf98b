#pragma once

// Rays against bounding slabs: t = (d - N . org) / (N . dir), with N . org and the reciprocals made once and shared by all volumes (Kay, Kajiya 1986).
//
// No false misses, u = kUnitRoundoff, |.|_1 sums of magnitudes, org measured from the slabs' common origin. Of a hit P at t, N . P is within
// 32 u |N| |P - org| of the slab (kSurfaceError), and |P - org| <= |t| |dir|_1. That, and the error of N . dir, 4 u |N| |dir|_1, grow with t and so are taken
// as a tilt of the slab's planes: kappa = 48 u |N| |dir|_1, of which the rest is for the roundings of t. For t >= 0 the plane that is met first has the slope
// |N . dir| + kappa then, the one that is left |N . dir| - kappa; for t < 0 it would be the other way round: 3 kappa |t_min| more room covers it where t_min <
// 0. N . org is wrong by 5 u |N| |org|_1 and gets room for 8. Nearly parallel, |N . dir| <= 2 kappa: the plane that is left says nothing of t but that the ray
// is below it, up to what slope and tilt amount to on the way through all that can be hit: 3 kappa |P - org| / |dir|, with |P - org| <= |org|_1 + radius and
// |dir|_1 <= 1.8 |dir| less than 260 u |N| (|org|_1 + radius). It gets room for 400, so that what is left over 2^-20 kappa is beyond any such P.

#include "core/bounds/volume_test_kernel.h"

namespace raymeter {

template <class L>
struct VolumeRays<KdopLayout, L> {
  using Float = typename L::Float;
  static constexpr bool kSigned = false;
  Float base_min[KdopLayout::kMaxSlabs];  ///< N . org, with room on the side of the slab's least plane
  Float base_max[KdopLayout::kMaxSlabs];
  Float inv_min[KdopLayout::kMaxSlabs];  ///< 1 / slope of the tilted least plane
  Float inv_max[KdopLayout::kMaxSlabs];

  void prepare(const KdopLayout::Shared& slabs, const RayPacket<L>& ray) noexcept {
    const Float zero(0.0f), one(1.0f);
    const Float org[3] = {ray.org[0] - Float(slabs.origin[0]), ray.org[1] - Float(slabs.origin[1]), ray.org[2] - Float(slabs.origin[2])};
    const Float org1 = L::abs(org[0]) + L::abs(org[1]) + L::abs(org[2]);
    const Float tilt = Float(48 * kUnitRoundoff) * (L::abs(ray.dir[0]) + L::abs(ray.dir[1]) + L::abs(ray.dir[2]));
    const Float behind = L::min(L::max(-ray.t_min, zero), Float(0x1p100f));
    const Float room = L::mul_add(Float(8 * kUnitRoundoff), org1, Float(3.0f) * tilt * behind);
    const Float room_parallel = Float(400 * kUnitRoundoff) * (org1 + Float(slabs.radius));
    for (std::int32_t i = 0; i < slabs.count; ++i) {
      const Float x(slabs.direction[i][0]), y(slabs.direction[i][1]), z(slabs.direction[i][2]), length(slabs.length[i]);
      const Float height = L::mul_add(org[2], z, L::mul_add(org[1], y, org[0] * x));
      const Float slope = L::mul_add(ray.dir[2], z, L::mul_add(ray.dir[1], y, ray.dir[0] * x));
      const Float kappa = tilt * length, steepness = L::abs(slope);
      const auto parallel = steepness <= kappa + kappa;
      const Float slack = length * (room + L::select(parallel, room_parallel, zero));
      const Float inv_first = one / (steepness + kappa);
      const Float inv_last = one / L::select(parallel, kappa * Float(0x1p-20f), steepness - kappa);
      const auto down = slope < zero;
      base_min[i] = height + slack;
      base_max[i] = height - slack;
      inv_min[i] = L::select(down, -inv_last, inv_first);
      inv_max[i] = L::select(down, -inv_first, inv_last);
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
      const Float t_min = (Float(planes[2 * i]) - rays.base_min[i]) * rays.inv_min[i];
      const Float t_max = (Float(planes[2 * i + 1]) - rays.base_max[i]) * rays.inv_max[i];
      t_near = L::max(L::min(t_min, t_max), t_near);
      t_far = L::min(L::max(t_min, t_max), t_far);
    }
    return {t_near, t_far};
  }
};

}  // namespace raymeter
