#pragma once

#include "accel/kdtree/kd_layout.h"
#include "core/ray/trace_args.h"
#include "core/simd/isa_enum.h"
#include "core/stats/counters.h"

namespace raymeter {

/// Packets through a k-d tree, front to back, each ray with an interval of its own.
template <Isa I, class Stats>
struct KdKernel {
  static void closest(const KdView& tree, const TraceArgs& args, Counters* counters) noexcept;
  static void any(const KdView& tree, const TraceArgs& args, Counters* counters) noexcept;
};

}  // namespace raymeter
