#pragma once

#include "accel/bvh/bvh_layout.h"
#include "core/ray/trace_args.h"
#include "core/simd/isa_enum.h"
#include "core/stats/counters.h"

namespace raymeter {

/// Stack traversal of a packet, front to back.
template <Isa I, class Stats>
struct BvhPacketKernel {
  static void closest(const BvhView& bvh, const TraceArgs& args, Counters* counters) noexcept;
  static void any(const BvhView& bvh, const TraceArgs& args, Counters* counters) noexcept;
};

}  // namespace raymeter
