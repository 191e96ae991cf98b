#pragma once

// What techniques with bounding volumes of any kind share: a packet against one volume, and the primitives in it.

#include "accel/volume_links_layout.h"
#include "core/bounds/volume_test_kernel.h"
#include "core/geometry/run_kernel.h"
#include "core/ray/packet_loop.h"
#include "core/stats/policy.h"

namespace raymeter {

/// A packet under way: the rays, which of them are live where the packet is, and what they bring to the volume tests.
template <class Layout, class L, int kGroups>
struct Travellers {
  Packet<L, kGroups>& packet;
  VolumeRays<Layout, L> rays[Packet<L, kGroups>::kCapacity];
  typename L::Mask live[Packet<L, kGroups>::kCapacity];

  Travellers(const typename Layout::Shared& shared, Packet<L, kGroups>& p) noexcept : packet(p) {
    for (int g = 0; g < packet.group_count(); ++g) {
      rays[g].prepare(shared, packet.ray[g]);
      live[g] = packet.live(g);
    }
  }

  template <Event e, class Stats>
  void count_live(Stats stats) const noexcept {
    if constexpr (Stats::kCounting) {
      for (int g = 0; g < packet.group_count(); ++g) {
        if (L::any(live[g])) stats.template count<e, L>(live[g]);
      }
    }
  }
};

/// Tests the live rays against the volume of link `c` and calls each(group, meets, entry) for each register of them; entry distances mean something where
/// `meets`, which is empty for registers without live rays.
template <bool kUniform, class Layout, class L, int kGroups, class Stats, class Each>
[[gnu::always_inline]] inline void test_volume(const VolumeLinksView<Layout>& links, const Travellers<Layout, L, kGroups>& travellers, std::int32_t octant,
                                               std::int32_t c, Stats stats, Each each) noexcept {
  const VolumeTest<Layout, L, kUniform> volume(links.shared, links.volume(c), octant);
  for (int g = 0; g < travellers.packet.group_count(); ++g) {
    const typename L::Mask live = travellers.live[g];
    if (kGroups != 1 && L::none(live)) {
      each(g, live, typename L::Float(0.0f));
      continue;
    }
    stats.template count<Event::volume_test, L>(live);
    const SlabInterval<L> interval = intersect_volume(travellers.packet.ray[g], travellers.rays[g], travellers.packet.hit[g].t, volume);
    each(g, live & (interval.t_near <= interval.t_far), interval.t_near);
  }
}

/// Tests the live rays against the primitives of a leaf.
template <Query Q, class Layout, class L, int kGroups, class Stats>
inline void visit_leaf(const VolumeLinksView<Layout>& links, Travellers<Layout, L, kGroups>& travellers, const VolumeLink& leaf, Stats stats) noexcept {
  travellers.template count_live<Event::leaf_visit>(stats);
  if (leaf.tag() != VolumeLink::kRuns) {
    test_run<Q, L, kGroups>(travellers.packet, travellers.live, links.pools, PrimitiveRun{leaf.tag_and_count, leaf.first}, nullptr, stats);
    return;
  }
  for (std::int32_t r = leaf.first; r < leaf.first + leaf.count(); ++r) {
    test_run<Q, L, kGroups>(travellers.packet, travellers.live, links.pools, links.runs[r], nullptr, stats);
  }
}

/// Calls traverse.operator()<kUniform>(octant): kUniform where the volume's test gains by direction signs and all rays of the packet share them.
template <class Layout, class L, int kGroups, class Traverse>
inline void with_signs(const Packet<L, kGroups>& packet, Traverse&& traverse) noexcept {
  if constexpr (VolumeRays<Layout, L>::kSigned) {
    const std::int32_t octant = packet.shared_octant();
    if (octant >= 0) return traverse.template operator()<true>(octant);
  }
  traverse.template operator()<false>(0);
}

}  // namespace raymeter
