#pragma once

#include <cstdint>

#include "core/geometry/primitive_run.h"
#include "core/ray/trace_args.h"
#include "core/scene/pools_view.h"
#include "core/simd/isa_enum.h"
#include "core/stats/counters.h"

namespace raymeter {

/// The whole scene as one leaf: at most one run per primitive kind.
struct ListView {
  PoolsView pools;
  PrimitiveRun run[kPrimKindCount];
  std::int32_t run_count;
};

template <Isa I, class Stats>
struct ListKernel {
  static void closest(const ListView& list, const TraceArgs& args, Counters* counters) noexcept;
  static void any(const ListView& list, const TraceArgs& args, Counters* counters) noexcept;
};

}  // namespace raymeter
