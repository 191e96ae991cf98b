#pragma once

#include "accel/bvh/bvh_layout.h"
#include "core/ray/trace_args.h"
#include "core/simd/isa_enum.h"
#include "core/stats/counters.h"

namespace raymeter {

/// Stack traversal of a packet, front to back. Defined in packet_traversal_kernel.h; instantiated in one *_kernel.cpp for each kind of volume.
template <class Layout>
struct BvhPacket {
  template <Isa I, class Stats>
  struct Kernel {
    static void closest(const BvhView<Layout>& bvh, const TraceArgs& args, Counters* counters) noexcept;
    static void any(const BvhView<Layout>& bvh, const TraceArgs& args, Counters* counters) noexcept;
  };
};

}  // namespace raymeter
