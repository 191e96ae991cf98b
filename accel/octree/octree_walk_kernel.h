#pragma once

#include "accel/octree/octree_layout.h"
#include "core/ray/trace_args.h"
#include "core/simd/isa_enum.h"
#include "core/stats/counters.h"

namespace raymeter {

/// Every ray goes from leaf to leaf and looks for the next from the root (point location) or from the leaf that it leaves (neighbour finding).
template <Isa I, class Stats>
struct OctreeWalkKernel {
  static void closest(const OctreeView& tree, const TraceArgs& args, Counters* counters) noexcept;
  static void any(const OctreeView& tree, const TraceArgs& args, Counters* counters) noexcept;
};

}  // namespace raymeter
