#pragma once

// The kernels of one form of the DDA. Each form, the default among them, has a file of its own that instantiates these and nothing else: what g++ makes of a
// function depends on what else a file holds (cell_walk_kernel.cpp in the same took a hundredth), and forms are to be compared.
//
// Memory: one offset per cell and kind of primitive into one array of references; a bit per cell says whether it lists anything. The walk and its proof:
// grid_walk_kernel.h; by lanes: grid_lanes_kernel.h.
//
// Events: node_visit for every step into a cell, the first one included (N_TS; executed once per register that steps). leaf_visit for the same cells (N_ETS),
// of them empty_leaf_visit where the list is empty (N_EETS); a list is executed once for the lanes of a register that stand in its cell, empty cells together.

#include "accel/grid/grid_kernel.h"
#include "accel/grid/grid_lanes_kernel.h"

namespace raymeter {

template <Isa I, class Stats, DdaForm F>
void GridLanesKernel<I, Stats, F>::closest(const GridView& grid, const TraceArgs& args, Counters* counters) noexcept {
  trace_by_lanes<Query::closest, Lanes<I>, F>(grid, args, Stats(counters));
}

template <Isa I, class Stats, DdaForm F>
void GridLanesKernel<I, Stats, F>::any(const GridView& grid, const TraceArgs& args, Counters* counters) noexcept {
  trace_by_lanes<Query::any, Lanes<I>, F>(grid, args, Stats(counters));
}

}  // namespace raymeter
