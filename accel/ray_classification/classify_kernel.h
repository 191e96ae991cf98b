#pragma once

#include "accel/ray_classification/ray_cells_layout.h"
#include "core/simd/isa_enum.h"

namespace raymeter {

/// Finds the keys of rays [first, first + count).
template <Isa I>
struct ClassifyKernel {
  static void keys(const RayClassFrame& frame, const RayView& rays, std::int32_t first, std::int32_t count, std::uint64_t* keys) noexcept;
};

}  // namespace raymeter
