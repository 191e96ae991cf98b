#pragma once

#include <cstddef>

#include "accel/bvh/binning_layout.h"
#include "core/simd/isa_enum.h"

namespace raymeter {

/// Makes the bins of boxes by their centres: the same on every instruction set, bit for bit.
template <Isa I>
struct BinningKernel {
  static void bin(const BinnedBox* boxes, std::size_t count, const BinMapping& mapping, Bins& bins) noexcept;
};

}  // namespace raymeter
