#pragma once

#include "accel/bvh/quantised_layout.h"
#include "accel/bvh/stream_layout.h"
#include "core/ray/trace_args.h"
#include "core/simd/isa_enum.h"
#include "core/stats/counters.h"

namespace raymeter {

/// Traversal of an 8-wide hierarchy by streams: rays sorted by octant and longest axis, in groups of args.packet at most.
template <Isa I, class Stats>
struct StreamKernel {
  static void closest(const WideBvhView& bvh, const TraceArgs& args, Counters* counters) noexcept;
  static void any(const WideBvhView& bvh, const TraceArgs& args, Counters* counters) noexcept;
  static void closest(const QuantisedBvhView& bvh, const TraceArgs& args, Counters* counters) noexcept;
  static void any(const QuantisedBvhView& bvh, const TraceArgs& args, Counters* counters) noexcept;
};

}  // namespace raymeter
