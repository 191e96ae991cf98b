#pragma once

// The lists of leaves, and what a packet remembers of its tests: a small table in the slice's scratch, looked up by the primitive's place in its pool
// (Shevtsov, Soupikov, Kapustin 2007: inverse mailboxing, with lanes instead of rays). A place that is taken is given to the latest, so a test may be repeated,
// but never is one left out: what a lane has tested has changed its hit already.

#include "accel/octree/octree_scratch_layout.h"
#include "core/geometry/run_kernel.h"
#include "core/ray/packet_loop.h"

namespace raymeter {

template <class L>
struct MailboxRefs {
  static constexpr bool kSelective = true;
  const std::int32_t* list;
  OctreeMailbox* mailbox;
  std::int32_t kind_count;
  std::int32_t kind;

  [[nodiscard]] std::int32_t index(std::int32_t k) const noexcept { return list[k]; }
  [[nodiscard]] typename L::Mask wanted(typename L::Mask lanes, int group, std::int32_t k) const noexcept {
    const std::int32_t key = list[k] * kind_count + kind;
    const std::int32_t place = key & (OctreeMailbox::kPlaces - 1);
    const std::uint64_t asking = std::uint64_t{L::bits(lanes)} << (group * L::kWidth);
    if (mailbox->key[place] != key) {
      mailbox->key[place] = key;
      mailbox->lanes[place] = asking;
      return lanes;
    }
    const std::uint64_t fresh = asking & ~mailbox->lanes[place];
    mailbox->lanes[place] |= asking;
    return fresh == asking ? lanes : L::mask(static_cast<std::uint32_t>(fresh >> (group * L::kWidth)));
  }
};

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
      test_refs<Q, L, kGroups>(packet, lanes, tree.pools, tree.kind[k], count, MailboxRefs<L>{list, &mailbox, tree.kind_count, k}, stats);
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
