#pragma once

// Axis-aligned boxes: slab_kernel.h has the test and its proof.

#include "core/bounds/volume_test_kernel.h"

namespace raymeter {

template <class L>
struct VolumeRays<AabbLayout, L> {
  static constexpr bool kSigned = true;
  void prepare(const AabbLayout::Shared&, const RayPacket<L>&) noexcept {}
};

template <class L, bool kUniform>
struct VolumeTest<AabbLayout, L, kUniform> {
  BoxPlanes<L, kUniform> planes;
  [[gnu::always_inline]] VolumeTest(const AabbLayout::Shared&, const float* data, std::int32_t octant) noexcept : planes(data, octant) {}
  [[nodiscard]] [[gnu::always_inline]] SlabInterval<L> line(const RayPacket<L>& ray, const VolumeRays<AabbLayout, L>&) const noexcept {
    return line_in_box(ray, planes);
  }
};

}  // namespace raymeter
