#pragma once

// Box tests without the guards of aabb_kernel.h, for the same boxes in the same memory. What is shared says which primitive tests go with them.
//   padded    the robust one
//   grown     (b - o) * (1 / d), with as much padding as is asked for
//   unpadded  (b - o) / d as it is rounded
//   fma       b / d - o / d in one fused operation, padded: NaN and infinities appear where a direction is 0, and o / d cancels far from the origin
//   quotient  (b - o) / d, divided at every plane, padded
// The reciprocal of grown, unpadded and fma is the packet's, or made of the processor's estimate, whose error comes on top of the test's own roundings. In
// units of kUnitRoundoff, against the quotient's 1: an estimate errs by 6144 (AVX-512: 1024), after Newton's step by the square of that, 2.3, and 2 roundings.
// The proof of slab_kernel.h then asks for a padding of 19 + 6147 and of 19 + 4.3; it leaves out directions that are denormal along an axis, whose estimate is
// infinite.

#include "core/bounds/aabb_kernel.h"
#include "core/bounds/weak_box_layout.h"
#include "core/simd/reciprocal_kernel.h"

namespace raymeter {

/// 1 / d, infinite where d is 0.
template <class L>
[[gnu::always_inline]] inline typename L::Float estimated_reciprocal(typename L::Float d, bool refine) noexcept {
  const typename L::Float estimate = reciprocal_estimate<L>(d);
  if (!refine) return estimate;
  const typename L::Float refined = L::mul_add(estimate, L::neg_mul_add(d, estimate, typename L::Float(1.0f)), estimate);
  return L::select(refined == refined, refined, estimate);  // 0 * infinity
}

template <BoxTest B, class L>
struct VolumeRays<WeakBoxLayout<B>, L> {
  static constexpr bool kSigned = true;
  VolumeRays<AabbLayout, L> robust;   // padded
  typename L::Float inv_dir[3];       // all but padded and quotient
  typename L::Float org_in_slabs[3];  // fma

  void prepare(const typename WeakBoxLayout<B>::Shared& shared, const RayPacket<L>& ray) noexcept {
    if constexpr (B == BoxTest::padded) robust.prepare(shared.boxes, ray);
    if constexpr (B == BoxTest::padded || B == BoxTest::quotient) return;
    for (int a = 0; a < 3; ++a) {
      inv_dir[a] = shared.reciprocal == Reciprocal::divide ? ray.inv_dir[a] : estimated_reciprocal<L>(ray.dir[a], shared.reciprocal == Reciprocal::newton);
      if constexpr (B == BoxTest::fma) org_in_slabs[a] = -ray.org[a] * inv_dir[a];
    }
  }
};

template <BoxTest B, class L, bool kUniform>
struct VolumeTest<WeakBoxLayout<B>, L, kUniform> {
  using Float = typename L::Float;
  BoxPlanes<L, kUniform> planes;
  float shrink, grow;

  [[gnu::always_inline]] VolumeTest(const typename WeakBoxLayout<B>::Shared& shared, const float* data, std::int32_t octant) noexcept
      : planes(data, octant), shrink(shared.shrink), grow(shared.grow) {}
  [[nodiscard]] [[gnu::always_inline]] SlabInterval<L> line(const RayPacket<L>& ray, const VolumeRays<WeakBoxLayout<B>, L>& rays) const noexcept {
    if constexpr (B == BoxTest::padded) return rays.robust.line(ray, planes);
    Float t_near(-kInfinity), t_far(kInfinity);
    for (int a = 0; a < 3; ++a) {
      const Float near_plane = kUniform ? planes.first[a] : L::select(ray.negative[a], planes.last[a], planes.first[a]);
      const Float far_plane = kUniform ? planes.last[a] : L::select(ray.negative[a], planes.first[a], planes.last[a]);
      t_near = L::max(met(near_plane, ray, rays, a), t_near);
      t_far = L::min(met(far_plane, ray, rays, a), t_far);
    }
    if constexpr (B == BoxTest::unpadded) return {t_near, t_far};
    if constexpr (B == BoxTest::fma) return {t_near * Float(1.0f - kSlabPadding), t_far * Float(1.0f + kSlabPadding)};
    return {L::mul_add(t_near, Float(shrink), -ray.slab_slack), L::mul_add(t_far, Float(grow), ray.slab_slack)};
  }

private:
  [[gnu::always_inline]] static Float met(Float plane, const RayPacket<L>& ray, const VolumeRays<WeakBoxLayout<B>, L>& rays, int a) noexcept {
    if constexpr (B == BoxTest::fma) return L::mul_add(plane, rays.inv_dir[a], rays.org_in_slabs[a]);
    if constexpr (B == BoxTest::quotient) return (plane - ray.org[a]) / ray.dir[a];
    return (plane - ray.org[a]) * rays.inv_dir[a];
  }
};

}  // namespace raymeter
