#pragma once

// Linear list in which every object stands behind its bounding volume (Whitted 1980; Weghorst, Hooper, Greenberg 1984): the oldest technique.
// Events: volume_test per ray and object, leaf_visit where the volume is met before the ray's nearest hit so far, prim_test per primitive in there.

#include "accel/list/bounded_list_kernel.h"
#include "accel/volume_links_kernel.h"

namespace raymeter {

template <Query Q, class L, class Layout, class Stats>
void trace_bounded_list(const BoundedListView<Layout>& list, const TraceArgs& args, Stats stats) noexcept {
  with_groups<L>(args.packet, [&]<int kGroups>() noexcept {
    for_each_packet<Q, L, kGroups>(args, [&](Packet<L, kGroups>& packet) noexcept {
      Travellers<Layout, L, kGroups> travellers(list.shared, packet);
      with_signs<Layout>(packet, [&]<bool kUniform>(std::int32_t octant) noexcept {
        for (std::int32_t object = 0; object < list.count; ++object) {
          bool any_met = false;
          for (int g = 0; g < packet.group_count(); ++g) travellers.live[g] = packet.live(g);
          test_volume<kUniform>(list, travellers, octant, object, stats, [&](int g, typename L::Mask meets, typename L::Float) noexcept {
            travellers.live[g] = meets;
            any_met |= L::any(meets);
          });
          if (any_met) visit_leaf<Q>(list, travellers, list.link(object), stats);
        }
      });
    });
  });
}

template <class Layout>
template <Isa I, class Stats>
void BoundedList<Layout>::Kernel<I, Stats>::closest(const BoundedListView<Layout>& list, const TraceArgs& args, Counters* counters) noexcept {
  trace_bounded_list<Query::closest, Lanes<I>>(list, args, Stats(counters));
}

template <class Layout>
template <Isa I, class Stats>
void BoundedList<Layout>::Kernel<I, Stats>::any(const BoundedListView<Layout>& list, const TraceArgs& args, Counters* counters) noexcept {
  trace_bounded_list<Query::any, Lanes<I>>(list, args, Stats(counters));
}

}  // namespace raymeter
