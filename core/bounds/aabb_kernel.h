#pragma once

// Axis-aligned boxes: slab_rays_kernel.h has the test and its proof. One ray by itself does better by slab_kernel.h: it has nobody to share the setting up
// with.

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
  void prepare(const AabbLayout::Shared&, const RayPacket<L>&) noexcept {}
  template <bool kUniform>
  [[nodiscard]] [[gnu::always_inline]] SlabInterval<L> line(const RayPacket<L>& ray, const BoxPlanes<L, kUniform>& planes) const noexcept {
    return line_in_box(ray, planes);
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
