// Traversal of a uniform grid slice by slice: grid_slices_kernel.h. Memory and events of lanes, to which some packets turn: dda_lanes_kernel.h.

#include "accel/grid/grid_slices_kernel.h"

#include "accel/grid/grid_kernel.h"

namespace raymeter {

namespace {

template <Query Q, class L, class Stats>
void trace_by_slices(const GridView& grid, const TraceArgs& args, Stats stats) noexcept {
  const std::int32_t in_beam = args.packet < kBeamRays ? args.packet : kBeamRays;
  with_groups<L>(in_beam, [&]<int kGroups>() noexcept { trace_slices<Q, L, kGroups>(grid, args, stats); });
}

}  // namespace

// A beam around one ray shares nothing.

template <Isa I, class Stats>
void GridSlicesKernel<I, Stats>::closest(const GridView& grid, const TraceArgs& args, Counters* counters) noexcept {
  if (args.packet == 1) return GridLanesKernel<I, Stats, DdaForm::recompute>::closest(grid, args, counters);
  trace_by_slices<Query::closest, Lanes<I>>(grid, args, Stats(counters));
}

template <Isa I, class Stats>
void GridSlicesKernel<I, Stats>::any(const GridView& grid, const TraceArgs& args, Counters* counters) noexcept {
  if (args.packet == 1) return GridLanesKernel<I, Stats, DdaForm::recompute>::any(grid, args, counters);
  trace_by_slices<Query::any, Lanes<I>>(grid, args, Stats(counters));
}

template struct GridSlicesKernel<kKernelIsa, NoStats>;
template struct GridSlicesKernel<kKernelIsa, CountStats>;

}  // namespace raymeter
