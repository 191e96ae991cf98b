#pragma once

#include "accel/octree/octree_layout.h"
#include "core/ray/trace_args.h"
#include "core/simd/isa_enum.h"
#include "core/stats/counters.h"

namespace raymeter {

/// The rays of a packet descend together, from cell to cell by their parameter.
template <Isa I, class Stats>
struct OctreeParametricKernel {
  static void closest(const OctreeView& tree, const TraceArgs& args, Counters* counters) noexcept;
  static void any(const OctreeView& tree, const TraceArgs& args, Counters* counters) noexcept;
};

}  // namespace raymeter
