#pragma once

// Tests of bounding volumes, each by itself on every instruction set, and volumes as they are stored and as pairs of planes.

#include <array>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>
#include <glm/vec3.hpp>

#include "core/simd/isa.h"
#include "experiments/micro/micro_kernel.h"
#include "tests/support/slab_truth.h"

namespace raymeter::test {

using VolumeKernel = MicroSums (*)(const MicroTargets&, const RayView&) noexcept;
struct Kernels {
  Isa isa;
  VolumeKernel boxes, oriented, slabs, spheres;
};
template <Isa I>
constexpr Kernels kernels_of() {
  return {I, MicroKernel<I>::bounding_boxes, MicroKernel<I>::oriented_boxes, MicroKernel<I>::bounding_slabs, MicroKernel<I>::bounding_spheres};
}
inline constexpr std::array kKernels{kernels_of<Isa::scalar>(), kernels_of<Isa::sse42>(), kernels_of<Isa::avx2>(), kernels_of<Isa::avx512>()};

inline void set(float (&out)[3], const glm::dvec3& p) {
  for (int a = 0; a < 3; ++a) out[a] = static_cast<float>(p[a]);
}

/// A volume as it is stored, and as pairs of planes.
struct Target {
  std::vector<float> data;
  std::vector<Slab> slabs;
  KdopLayout::Shared shared{};
  double size = 1;
  glm::dvec3 middle{0.0};
};

/// Rays of all volumes that truly meet theirs, and those that each instruction set loses.
struct Count {
  std::int64_t rays = 0;
  std::array<double, kKernels.size()> met{};
};

inline void trace(const Target& target, const RayBatch& rays, VolumeKernel Kernels::*kernel, Count& count) {
  count.rays += static_cast<std::int64_t>(rays.size());
  const MicroTargets targets{{}, target.data.data(), static_cast<std::int32_t>(target.data.size()), target.shared, 1};
  for (std::size_t k = 0; k < kKernels.size(); ++k) {
    if (available(kKernels[k].isa) && rays.size() > 0) count.met[k] += double{(kKernels[k].*kernel)(targets, rays.view()).hits};
  }
}

inline void expect_all_met(const Count& count, std::int64_t at_least) {
  EXPECT_GE(count.rays, at_least);
  for (std::size_t k = 0; k < kKernels.size(); ++k) {
    if (!available(kKernels[k].isa)) continue;
    EXPECT_EQ(count.met[k], static_cast<double>(count.rays)) << name(kKernels[k].isa);
  }
}

}  // namespace raymeter::test
