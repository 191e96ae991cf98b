#pragma once

#include "accel/grid/grid_layout.h"
#include "core/ray/trace_args.h"
#include "core/simd/isa_enum.h"
#include "core/stats/counters.h"

namespace raymeter {

/// 3D-DDA: rays go from cell to cell, each its own way, and those of a packet that stand in the same cell are tested together.
template <Isa I, class Stats>
struct GridLanesKernel {
  static void closest(const GridView& grid, const TraceArgs& args, Counters* counters) noexcept;
  static void any(const GridView& grid, const TraceArgs& args, Counters* counters) noexcept;
};

/// Slice by slice: the beams of a packet go through the grid together.
template <Isa I, class Stats>
struct GridSlicesKernel {
  static void closest(const GridView& grid, const TraceArgs& args, Counters* counters) noexcept;
  static void any(const GridView& grid, const TraceArgs& args, Counters* counters) noexcept;
};

}  // namespace raymeter
