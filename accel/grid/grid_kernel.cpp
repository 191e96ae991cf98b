// Traversals of a uniform grid. Memory: one offset per cell and kind of primitive into one array of references; a bit per cell says whether it lists anything.
// The DDA and its proofs: grid_walk_kernel.h; by lanes: grid_lanes_kernel.h; by slices: grid_slices_kernel.h.
//
// Events by lanes: node_visit for every step into a cell, the first one included (N_TS; executed once per register that steps). leaf_visit for the same cells
// (N_ETS), of them empty_leaf_visit where the list is empty (N_EETS); a list is executed once for the lanes of a register that stand in its cell, empty cells
// together.

#include "accel/grid/grid_kernel.h"

#include "accel/grid/grid_lanes_kernel.h"
#include "accel/grid/grid_slices_kernel.h"

namespace raymeter {

namespace {

template <Query Q, class L, class Stats>
void trace_by_slices(const GridView& grid, const TraceArgs& args, Stats stats) noexcept {
  if (args.packet == 1) return trace_by_lanes<Q, L, DdaForm::recompute>(grid, args, stats);  // a beam around one ray shares nothing
  const std::int32_t in_beam = args.packet < kBeamRays ? args.packet : kBeamRays;
  with_groups<L>(in_beam, [&]<int kGroups>() noexcept { trace_slices<Q, L, kGroups>(grid, args, stats); });
}

}  // namespace

template <Isa I, class Stats>
void GridLanesKernel<I, Stats>::closest(const GridView& grid, const TraceArgs& args, Counters* counters) noexcept {
  trace_by_lanes<Query::closest, Lanes<I>, DdaForm::recompute>(grid, args, Stats(counters));
}

template <Isa I, class Stats>
void GridLanesKernel<I, Stats>::any(const GridView& grid, const TraceArgs& args, Counters* counters) noexcept {
  trace_by_lanes<Query::any, Lanes<I>, DdaForm::recompute>(grid, args, Stats(counters));
}

template <Isa I, class Stats>
void GridSlicesKernel<I, Stats>::closest(const GridView& grid, const TraceArgs& args, Counters* counters) noexcept {
  trace_by_slices<Query::closest, Lanes<I>>(grid, args, Stats(counters));
}

template <Isa I, class Stats>
void GridSlicesKernel<I, Stats>::any(const GridView& grid, const TraceArgs& args, Counters* counters) noexcept {
  trace_by_slices<Query::any, Lanes<I>>(grid, args, Stats(counters));
}

template struct GridLanesKernel<kKernelIsa, NoStats>;
template struct GridLanesKernel<kKernelIsa, CountStats>;
template struct GridSlicesKernel<kKernelIsa, NoStats>;
template struct GridSlicesKernel<kKernelIsa, CountStats>;

}  // namespace raymeter
