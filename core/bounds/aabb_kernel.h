#pragma once

// Axis-aligned boxes: slab_rays_kernel.h has the test and its proof. One ray by itself does better by slab_kernel.h, intervals growing with the reciprocals: it
// has nobody to share the setting up with.

#include "core/bounds/slab_rays_kernel.h"
#include "core/bounds/volume_test_kernel.h"

namespace raymeter {

template <class L>
struct VolumeRays<AabbLayout, L> {
  static constexpr bool kSigned = true;
  SlabRays<L> slabs;
  void prepare(const AabbLayout::Shared& shared, const RayPacket<L>& ray) noexcept { slabs.prepare(ray, shared.reach); }
  template <bool kUniform>
  [[nodiscard]] [[gnu::always_inline]] SlabInterval<L> line(const RayPacket<L>& ray, const BoxPlanes<L, kUniform>& planes) const noexcept {
    return line_in_box(ray, slabs, planes);
  }
};

template <class L>
requires(L::kWidth == 1) struct VolumeRays<AabbLayout, L> {
  static constexpr bool kSigned = true;
  typename L::Float near_scale[3], far_scale[3];  // 1 / dir and how much intervals grow: with it, 4 roundings in all
  void prepare(const AabbLayout::Shared&, const RayPacket<L>& ray) noexcept {
    for (int a = 0; a < 3; ++a) {
      near_scale[a] = ray.inv_dir[a] * typename L::Float(1.0f - kSlabPadding);
      far_scale[a] = ray.inv_dir[a] * typename L::Float(1.0f + kSlabPadding);
    }
  }
  template <bool kUniform>
  [[nodiscard]] [[gnu::always_inline]] SlabInterval<L> line(const RayPacket<L>& ray, const BoxPlanes<L, kUniform>& planes) const noexcept {
    const auto [t_near, t_far] = line_between_planes(ray, planes, near_scale, far_scale);
    return {t_near - ray.slab_slack, t_far + ray.slab_slack};
  }
};

template <class L, bool kUniform>
struct VolumeTest<AabbLayout, L, kUniform> {
  BoxPlanes<L, kUniform> planes;
  [[gnu::always_inline]] VolumeTest(const AabbLayout::Shared&, const float* data, std::int32_t octant) noexcept : planes(data, octant) {}
  [[nodiscard]] [[gnu::always_inline]] SlabInterval<L> line(const RayPacket<L>& ray, const VolumeRays<AabbLayout, L>& rays) const noexcept {
    return rays.line(ray, planes);
  }
};

}  // namespace raymeter
