#pragma once

// Rays against an oriented box: the slab test along the box's axes a_i, as stored. All is measured from the box's centre.
//
// No false misses, u = kUnitRoundoff, F = org - centre, r the box's reach: of a hit P, |a_i . (P - centre)| <= h_i + 33 u |P - org| (kSurfaceError, |a_i| = 1
// up to roundings), and |P - org| <= |F| + r up to roundings, whatever the distance in t. To that add, along a_i: for a_i . F 5 u |F|_1, for the change along
// the ray, (a_i . dir) t, 7 u |P - org|, and for t's own arithmetic, with one division for three reciprocals, 10 u (|F| + r). A slope below 2^-40 of dir_unit
// is taken for that, which is less than a rounding. Together less than 64 u (|F|_1 + r), by which the half widths grow.

#include "core/bounds/volume_test_kernel.h"

namespace raymeter {

template <class L>
struct VolumeRays<ObbLayout, L> {
  using Float = typename L::Float;
  static constexpr bool kSigned = false;
  Float dir[3];    // RayPacket::dir in units of dir_unit, so that no product of slopes underflows
  Float per_unit;  // 1 / dir_unit

  void prepare(const ObbLayout::Shared&, const RayPacket<L>& ray) noexcept {
    per_unit = Float(1.0f) / dir_unit(ray);
    for (int a = 0; a < 3; ++a) dir[a] = ray.dir[a] * per_unit;
  }
};

template <class L, bool kUniform>
struct VolumeTest<ObbLayout, L, kUniform> {
  using Float = typename L::Float;
  const float* box;

  [[gnu::always_inline]] VolumeTest(const ObbLayout::Shared&, const float* data, std::int32_t) noexcept : box(data) {}

  [[nodiscard]] [[gnu::always_inline]] SlabInterval<L> line(const RayPacket<L>& ray, const VolumeRays<ObbLayout, L>& rays) const noexcept {
    const float* const axes = box + 3;
    const float* const half = box + 12;
    const Float f[3] = {ray.org[0] - Float(box[0]), ray.org[1] - Float(box[1]), ray.org[2] - Float(box[2])};
    const Float growth = Float(64 * kUnitRoundoff) * (L::abs(f[0]) + L::abs(f[1]) + (L::abs(f[2]) + Float(box[15])));
    Float height[3], slope[3];
    for (int i = 0; i < 3; ++i) {
      const Float x(axes[3 * i]), y(axes[3 * i + 1]), z(axes[3 * i + 2]);
      height[i] = L::mul_add(f[2], z, L::mul_add(f[1], y, f[0] * x));
      const Float s = L::mul_add(rays.dir[2], z, L::mul_add(rays.dir[1], y, rays.dir[0] * x));
      const Float least(0x1p-40f);
      slope[i] = L::select(L::abs(s) < least, least, s);
    }
    const Float yz = slope[1] * slope[2];
    const Float inverse = rays.per_unit / (slope[0] * yz);
    const Float x_inverse = slope[0] * inverse;
    const Float inv_slope[3] = {yz * inverse, slope[2] * x_inverse, slope[1] * x_inverse};
    Float t_near(-kInfinity), t_far(kInfinity);
    for (int i = 0; i < 3; ++i) {
      const Float middle = -height[i] * inv_slope[i];
      const Float reach = (Float(half[i]) + growth) * L::abs(inv_slope[i]);
      t_near = L::max(middle - reach, t_near);
      t_far = L::min(middle + reach, t_far);
    }
    return {t_near, t_far};
  }
};

}  // namespace raymeter
