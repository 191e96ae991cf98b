#pragma once

// The lists of leaves, and what they count.

#include "accel/octree/octree_scratch_layout.h"
#include "core/geometry/run_kernel.h"
#include "core/ray/packet_loop.h"

namespace raymeter {

/// Tests the lanes of a packet against the list of a leaf.
template <Query Q, class L, int kGroups, class Stats>
inline void test_leaf(const OctreeView& tree, std::int32_t leaf, Packet<L, kGroups>& packet, const typename L::Mask* lanes, OctreeMailbox& mailbox,
                      Stats stats) noexcept {
  const std::int32_t* const slot = tree.first + static_cast<std::int64_t>(leaf) * tree.kind_count;
  for (std::int32_t k = 0; k < tree.kind_count; ++k) {
    const std::int32_t count = slot[k + 1] - slot[k];
    if (count == 0) continue;
    const std::int32_t* const list = tree.refs + slot[k];
    if (tree.mailbox)
      test_refs<Q, L, kGroups>(packet, lanes, tree.pools, tree.kind[k], count,
                               UnmetRefs<L, OctreeMailbox::kSlots>{list, static_cast<std::uint32_t>(k), &mailbox}, stats);
    else
      test_refs<Q, L, kGroups>(packet, lanes, tree.pools, tree.kind[k], count, ListedRefs{list}, stats);
  }
}

/// Counts a visit to a cell by each register that has a lane in it.
template <Event e, class L, class Stats>
inline void count_visit(const typename L::Mask* lanes, int groups, Stats stats) noexcept {
  if constexpr (Stats::kCounting) {
    for (int g = 0; g < groups; ++g) {
      if (L::any(lanes[g])) stats.template count<e, L>(lanes[g]);
    }
  }
}

/// A visit to a leaf.
template <Query Q, class L, int kGroups, class Stats>
inline void visit_leaf(const OctreeView& tree, std::int32_t leaf, Packet<L, kGroups>& packet, const typename L::Mask* lanes, OctreeMailbox& mailbox,
                       Stats stats) noexcept {
  count_visit<Event::node_visit, L>(lanes, packet.group_count(), stats);
  count_visit<Event::leaf_visit, L>(lanes, packet.group_count(), stats);
  if (leaf == 0)
    count_visit<Event::empty_leaf_visit, L>(lanes, packet.group_count(), stats);
  else
    test_leaf<Q>(tree, leaf, packet, lanes, mailbox, stats);
}

/// Tests the lanes against everything.
template <Query Q, class L, int kGroups, class Stats>
inline void test_everything(const OctreeView& tree, Packet<L, kGroups>& packet, const typename L::Mask* lanes, Stats stats) noexcept {
  for (std::int32_t k = 0; k < tree.kind_count; ++k) {
    test_refs<Q, L, kGroups>(packet, lanes, tree.pools, tree.kind[k], tree.prim_count[k], PositionRefs{0}, stats);
  }
}

/// Lanes whose origins are near enough for lists that reach beyond their cells by a margin.
template <class L>
inline typename L::Mask within_reach(const OctreeView& tree, const RayPacket<L>& ray) noexcept {
  using Float = typename L::Float;
  typename L::Mask near_enough = ray.t_min == ray.t_min;
  for (int a = 0; a < 3; ++a) near_enough = near_enough & (L::abs(ray.org[a] - Float(tree.center[a])) <= Float(tree.reach));
  return near_enough;
}

}  // namespace raymeter
