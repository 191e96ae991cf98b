#pragma once

#include "accel/ray_classification/ray_cells_layout.h"
#include "core/ray/trace_args.h"
#include "core/simd/isa_enum.h"
#include "core/stats/counters.h"

namespace raymeter {

/// Packets of rays of one cell against its list. args.rays, args.hits and args.blocker are the whole batch's; args.rays.count is the slice's.
template <Isa I, class Stats>
struct RayClassificationKernel {
  static void closest(const RayCellsView& view, const TraceArgs& args, Counters* counters) noexcept;
  static void any(const RayCellsView& view, const TraceArgs& args, Counters* counters) noexcept;
};

}  // namespace raymeter
