#pragma once

#include "accel/grid/recursive_grid_layout.h"
#include "core/ray/trace_args.h"
#include "core/simd/isa_enum.h"
#include "core/stats/counters.h"

namespace raymeter {

/// 3D-DDA through grids in cells of grids.
template <Isa I, class Stats>
struct RecursiveGridKernel {
  static void closest(const RecursiveGridView& grid, const TraceArgs& args, Counters* counters) noexcept;
  static void any(const RecursiveGridView& grid, const TraceArgs& args, Counters* counters) noexcept;
};

}  // namespace raymeter
