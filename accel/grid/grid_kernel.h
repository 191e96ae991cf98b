#pragma once

#include "accel/grid/grid_layout.h"
#include "core/ray/trace_args.h"
#include "core/simd/isa_enum.h"
#include "core/stats/counters.h"

namespace raymeter {

/// 3D-DDA by one of its forms: rays go from cell to cell, each its own way, and those of a packet that stand in the same cell are tested together.
template <Isa I, class Stats, DdaForm F>
struct GridLanesKernel {
  static void closest(const GridView& grid, const TraceArgs& args, Counters* counters) noexcept;
  static void any(const GridView& grid, const TraceArgs& args, Counters* counters) noexcept;
};

/// The cells that the same walk leads rays through, past all primitives. Those of ray i go to cells[i * stride ...], how many there are to count[i]: 0 where
/// the ray is invalid or passes the grid by, kWalksEverywhere where it is tested against everything. `stride`: nx + ny + nz - 2 or more.
template <Isa I, DdaForm F>
struct CellWalkKernel {
  static void walk(const GridView& grid, const RayView& rays, std::int32_t stride, std::int32_t* cells, std::int32_t* count) noexcept;
};

/// Slice by slice: the beams of a packet go through the grid together.
template <Isa I, class Stats>
struct GridSlicesKernel {
  static void closest(const GridView& grid, const TraceArgs& args, Counters* counters) noexcept;
  static void any(const GridView& grid, const TraceArgs& args, Counters* counters) noexcept;
};

}  // namespace raymeter
