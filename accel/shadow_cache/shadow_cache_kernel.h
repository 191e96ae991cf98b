#pragma once

#include <cstdint>

#include "core/ray/trace_args.h"
#include "core/scene/pools_view.h"
#include "core/scene/primitive.h"
#include "core/simd/isa_enum.h"
#include "core/stats/counters.h"

namespace raymeter {

/// For each ray of a slice the primitive that is to be tested; a dropped one stands for none.
struct CachedBlockersView {
  PoolsView pools;
  const PrimRef* blocker;  ///< readable kMaxPacket elements past the slice's end
};

template <Isa I, class Stats>
struct ShadowCacheKernel {
  /// args.blocker gets the cached primitive's id where it blocks, else -1.
  static void any(const CachedBlockersView& cached, const TraceArgs& args, Counters* counters) noexcept;
};

}  // namespace raymeter
