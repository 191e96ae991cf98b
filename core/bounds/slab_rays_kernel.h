#pragma once

// Rays against axis-aligned boxes by one fused operation a plane, with no false misses: t = plane * scale + at_zero, where scale is 1 / dir and at_zero is
// -org / dir, made once for a register of rays. Those for the planes that rays meet first and last differ by all that an interval has to grow.
//
// Proof, u = kUnitRoundoff, T = (plane - org) / dir, for planes that are met first; the others mirror it. scale is (1 - kSlabPadding) / dir within 2 u. at_zero
// is not above -org * scale: the sign of what rounding leaves of that is exact. So plane * scale + at_zero is not above (plane - org) * scale, and rounded
// once: T (1 - kSlabPadding) (1 + 3 u), before any hit that the contract allows (error_bounds.h); at_zero holds slab_slack (t_min < 0), 2^-126 (denormals) too.
// Without a fused operation the product is rounded too, by u T and u org / dir; at_zero is lower by that. In space, boxes grow by 1 to 6 u |org|: false boxes,
// and few of them unless boxes are not much larger than the last place of the origin's coordinates. Directions below kLeastSlope of the largest are taken for
// it, so that nothing is infinite or NaN. No hit is at a t beyond `reach` + the largest |org| over dir_unit: that much times kLeastSlope times dir_unit the ray
// is off at most, which moves t by twice as much as t itself. An origin beyond 2^60 says nothing on its axis.

#include "core/bounds/slab_kernel.h"

namespace raymeter {

/// The least |dir| that planes are met at, in units of dir_unit.
inline constexpr float kLeastSlope = 0x1p-40f;

/// What a register of rays brings to the boxes: t_near is the greatest of plane * near_scale + near_at_zero, t_far the least of the others.
template <class L>
struct SlabRays {
  using Float = typename L::Float;
  Float near_scale[3], near_at_zero[3];
  Float far_scale[3], far_at_zero[3];

  /// `reach`: the largest |coordinate| of any box.
  void prepare(const RayPacket<L>& ray, float reach) noexcept {
    const Float farthest = L::max(L::max(L::abs(ray.org[0]), L::abs(ray.org[1])), L::abs(ray.org[2])) + Float(reach);
    const Float unit = dir_unit(ray), per_unit = Float(1.0f) / unit;
    const Float least = unit * Float(kLeastSlope), most = per_unit * Float(1 / kLeastSlope);
    const Float longest = farthest * per_unit;
    const Float rounding = ray.slab_slack + Float(0x1p-126f);  // the least normal: denormal operands are slow
    for (int a = 0; a < 3; ++a) {
      const auto flat = L::abs(ray.dir[a]) < least;
      const auto beyond = ~(L::abs(ray.org[a]) < Float(0x1p60f));
      const Float slope = L::select(flat, L::select(ray.negative[a], -most, most), ray.inv_dir[a]);
      const Float inverse = L::select(beyond, L::select(ray.negative[a], Float(-0x1p-60f), Float(0x1p-60f)), slope);
      const Float more = L::select(flat, L::mul_add(longest, Float(2 + 0x1p-15f), rounding), rounding);
      const Float growth = L::select(beyond, Float(kLargest), more);
      near_scale[a] = inverse * Float(1.0f - kSlabPadding);
      far_scale[a] = inverse * Float(1.0f + kSlabPadding);
      near_at_zero[a] = -at_zero_above(-ray.org[a], near_scale[a], growth);
      far_at_zero[a] = at_zero_above(ray.org[a], far_scale[a], growth);
    }
  }

private:
  /// Not below growth - org * scale; where there is a fused operation, one of the two least such floats.
  static Float at_zero_above(Float org, Float scale, Float growth) noexcept {
    if constexpr (L::kIsa < Isa::avx2) {
      const Float product = org * scale;
      return L::mul_add(L::abs(product), Float(5 * kUnitRoundoff), growth - product);
    }
    const Float nearest = L::neg_mul_add(org, scale, growth);
    const Float above = L::mul_add(L::abs(nearest), Float(1.25f * kUnitRoundoff), nearest);
    return L::select(L::neg_mul_add(org, scale, -nearest) >= -growth, above, nearest);
  }
};

/// The whole line's interval in the box, not clipped to the ray's.
template <class L, bool kUniform>
[[gnu::always_inline]] inline SlabInterval<L> line_in_box(const RayPacket<L>& ray, const SlabRays<L>& slabs, const BoxPlanes<L, kUniform>& planes) noexcept {
  using Float = typename L::Float;
  SlabInterval<L> line{Float(-kInfinity), Float(kInfinity)};
  for (int a = 0; a < 3; ++a) {
    const Float near_plane = kUniform ? planes.first[a] : L::select(ray.negative[a], planes.last[a], planes.first[a]);
    const Float far_plane = kUniform ? planes.last[a] : L::select(ray.negative[a], planes.first[a], planes.last[a]);
    line.t_near = L::max(L::mul_add(near_plane, slabs.near_scale[a], slabs.near_at_zero[a]), line.t_near);
    line.t_far = L::min(L::mul_add(far_plane, slabs.far_scale[a], slabs.far_at_zero[a]), line.t_far);
  }
  return line;
}

}  // namespace raymeter
