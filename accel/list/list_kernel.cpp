// Linear list. Memory: the scene's own pools. Events: leaf_visit once per packet, prim_test per packet and primitive; no nodes.

#include "accel/list/list_kernel.h"

#include "core/geometry/run_kernel.h"
#include "core/ray/packet_loop.h"
#include "core/stats/policy.h"

namespace raymeter {

namespace {

template <Query Q, class L, int kGroups, class Stats>
void trace(const ListView& list, const TraceArgs& args, Stats stats) noexcept {
  for_each_packet<Q, L, kGroups>(args, [&](Packet<L, kGroups>& packet) noexcept {
    typename L::Mask live[Packet<L, kGroups>::kCapacity];
    for (int g = 0; g < packet.group_count(); ++g) {
      live[g] = packet.live(g);
      stats.template count<Event::leaf_visit, L>(live[g]);
    }
    for (std::int32_t r = 0; r < list.run_count; ++r) test_run<Q, L, kGroups>(packet, live, list.pools, list.run[r], nullptr, stats);
  });
}

}  // namespace

template <Isa I, class Stats>
void ListKernel<I, Stats>::closest(const ListView& list, const TraceArgs& args, Counters* counters) noexcept {
  with_groups<Lanes<I>>(args.packet, [&]<int kGroups>() noexcept { trace<Query::closest, Lanes<I>, kGroups>(list, args, Stats(counters)); });
}

template <Isa I, class Stats>
void ListKernel<I, Stats>::any(const ListView& list, const TraceArgs& args, Counters* counters) noexcept {
  with_groups<Lanes<I>>(args.packet, [&]<int kGroups>() noexcept { trace<Query::any, Lanes<I>, kGroups>(list, args, Stats(counters)); });
}

template struct ListKernel<kKernelIsa, NoStats>;
template struct ListKernel<kKernelIsa, CountStats>;

}  // namespace raymeter
