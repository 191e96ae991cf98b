#pragma once

// Box tests without the guards of aabb_kernel.h, for the same boxes in the same memory. What is shared says which primitive tests go with them.
//   padded    the robust one
//   unpadded  (b - o) / d as it is rounded
//   fma       b / d - o / d in one fused operation, padded: NaN and infinities appear where a direction is 0, and o / d cancels far from the origin

#include "core/bounds/aabb_kernel.h"
#include "core/bounds/weak_box_layout.h"

namespace raymeter {

template <BoxTest B, class L>
struct VolumeRays<WeakBoxLayout<B>, L> {
  static constexpr bool kSigned = true;
  VolumeRays<AabbLayout, L> robust;   // padded
  typename L::Float org_in_slabs[3];  // fma

  void prepare(const typename WeakBoxLayout<B>::Shared& shared, const RayPacket<L>& ray) noexcept {
    if constexpr (B == BoxTest::padded) robust.prepare(shared.boxes, ray);
    if constexpr (B == BoxTest::fma) {
      for (int a = 0; a < 3; ++a) org_in_slabs[a] = -ray.org[a] * ray.inv_dir[a];
    }
  }
};

template <BoxTest B, class L, bool kUniform>
struct VolumeTest<WeakBoxLayout<B>, L, kUniform> {
  using Float = typename L::Float;
  BoxPlanes<L, kUniform> planes;

  [[gnu::always_inline]] VolumeTest(const typename WeakBoxLayout<B>::Shared&, const float* data, std::int32_t octant) noexcept : planes(data, octant) {}
  [[nodiscard]] [[gnu::always_inline]] SlabInterval<L> line(const RayPacket<L>& ray, const VolumeRays<WeakBoxLayout<B>, L>& rays) const noexcept {
    if constexpr (B == BoxTest::padded) return rays.robust.line(ray, planes);
    Float t_near(-kInfinity), t_far(kInfinity);
    for (int a = 0; a < 3; ++a) {
      const Float near_plane = kUniform ? planes.first[a] : L::select(ray.negative[a], planes.last[a], planes.first[a]);
      const Float far_plane = kUniform ? planes.last[a] : L::select(ray.negative[a], planes.first[a], planes.last[a]);
      t_near = L::max(met(near_plane, ray, rays, a), t_near);
      t_far = L::min(met(far_plane, ray, rays, a), t_far);
    }
    if constexpr (B == BoxTest::fma) return {t_near * Float(1.0f - kSlabPadding), t_far * Float(1.0f + kSlabPadding)};
    return {t_near, t_far};
  }

private:
  [[gnu::always_inline]] static Float met(Float plane, const RayPacket<L>& ray, const VolumeRays<WeakBoxLayout<B>, L>& rays, int a) noexcept {
    if constexpr (B == BoxTest::fma) return L::mul_add(plane, ray.inv_dir[a], rays.org_in_slabs[a]);
    return (plane - ray.org[a]) * ray.inv_dir[a];
  }
};

}  // namespace raymeter
