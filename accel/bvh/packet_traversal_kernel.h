#pragma once

// Packet traversal of a bounding volume hierarchy: all rays of a packet descend together (Wald et al. 2001, Boulos et al. 2006), each lane culled by its own
// entry distance, so that a lane opens a node exactly when a lone ray would in this order; with packet = 1 the order is nearest child first.
//
// A stack entry is a link and the distance at which each lane enters its volume, NaN where the lane misses it. A lane is live in an entry while that distance
// is not beyond its hit. Events: node_visit when the children of an inner node are looked at, volume_test per child (the root's own volume counts too),
// leaf_visit when a leaf's primitives are tested.

#include "accel/bvh/packet_kernel.h"
#include "accel/volume_links_kernel.h"

namespace raymeter {

/// Entries of the traversal stack. An entry's distances stand in a row of their own, [group][lane]; entries change places without moving rows: `row` is a
/// permutation of all rows, of which those at `size` and above are free.
template <class L, int kGroups>
struct BvhStack {
  float* distances;
  float* key;  // the entry distance of one lane, to order siblings by
  std::int32_t* link;
  std::int32_t* row;
  std::int32_t row_floats;
  std::int32_t size = 0;

  BvhStack(std::byte* scratch, std::int32_t capacity, std::int32_t groups) noexcept
      : distances(reinterpret_cast<float*>(scratch)),
        key(distances + static_cast<std::int64_t>(capacity) * groups * L::kWidth),
        link(reinterpret_cast<std::int32_t*>(key + capacity)),
        row(link + capacity),
        row_floats(groups * L::kWidth) {
    for (std::int32_t e = 0; e < capacity; ++e) row[e] = e;
  }
  [[nodiscard]] float* distances_of(std::int32_t entry) const noexcept {
    return distances + static_cast<std::int64_t>(row[entry]) * (kGroups > 0 ? kGroups * L::kWidth : row_floats);
  }
  void swap(std::int32_t e, std::int32_t f) noexcept {
    const auto exchange = [](auto& a, auto& b) noexcept {
      const auto c = a;
      a = b;
      b = c;
    };
    exchange(key[e], key[f]);
    exchange(link[e], link[f]);
    exchange(row[e], row[f]);
  }
  /// Moves the topmost entry below its siblings that are nearer; those begin at `bottom`.
  void sink(std::int32_t bottom) noexcept {
    for (std::int32_t e = size - 1; e > bottom && key[e] > key[e - 1]; --e) swap(e, e - 1);
  }
  /// Puts the nearest of the entries from `bottom` on to the top: heap sort, for nodes of many children.
  void sort(std::int32_t bottom) noexcept {
    const std::int32_t count = size - bottom;
    const auto sift = [&](std::int32_t at, std::int32_t end) noexcept {  // the nearest of a heap is its first
      for (std::int32_t child = 2 * at + 1; child < end; child = 2 * at + 1) {
        if (child + 1 < end && key[bottom + child + 1] < key[bottom + child]) ++child;
        if (!(key[bottom + child] < key[bottom + at])) return;
        swap(bottom + at, bottom + child);
        at = child;
      }
    };
    for (std::int32_t at = count / 2 - 1; at >= 0; --at) sift(at, count);
    for (std::int32_t end = count - 1; end > 0; --end) {
      swap(bottom, bottom + end);
      sift(0, end);
    }
  }
};

/// Asks early for what a link leads to: large trees do not fit the caches, and a packet waits longer for memory than it computes.
template <class Layout>
[[gnu::always_inline]] inline void prefetch_target(const BvhView<Layout>& bvh, const VolumeLink& link) noexcept {
  if (link.tag() == VolumeLink::kInner) {
    __builtin_prefetch(bvh.address(link.first));
  } else if (link.tag() == static_cast<std::uint32_t>(PrimKind::triangle)) {
    const float* const record = bvh.pools.triangles.vertex[0][0] + static_cast<std::int64_t>(link.first) * bvh.pools.triangles.stride;
    __builtin_prefetch(record);
    __builtin_prefetch(record + 16);
  }
}

/// Pushes link `c` where any live lane meets its volume.
template <bool kUniform, class Layout, class L, int kGroups, class Stats>
[[gnu::always_inline]] inline void push_if_met(const BvhView<Layout>& bvh, const Travellers<Layout, L, kGroups>& travellers, std::int32_t octant,
                                               std::int32_t c, BvhStack<L, kGroups>& stack, Stats stats) noexcept {
  using Float = typename L::Float;
  float* const out = stack.distances_of(stack.size);
  std::uint64_t met = 0;
  test_volume<kUniform>(bvh, travellers, octant, c, stats, [&](int g, typename L::Mask meets, Float entry) noexcept {
    L::store(out + g * L::kWidth, L::select(meets, entry, Float(__builtin_nanf(""))));
    met |= std::uint64_t{L::bits(meets)} << (g * L::kWidth);
  });
  if (met == 0) return;
  stack.key[stack.size] = out[__builtin_ctzll(met)];
  stack.link[stack.size++] = c;
}

template <Query Q, bool kUniform, class Layout, class L, int kGroups, class Stats>
void traverse_by_stack(const BvhView<Layout>& bvh, BvhStack<L, kGroups>& stack, Packet<L, kGroups>& packet, std::int32_t octant, Stats stats) noexcept {
  constexpr std::int32_t kManyChildren = 32;
  Travellers<Layout, L, kGroups> travellers(bvh.shared, packet);
  push_if_met<kUniform>(bvh, travellers, octant, 0, stack, stats);
  while (stack.size > 0) {
    const float* const t_near = stack.distances_of(--stack.size);
    const VolumeLink& link = bvh.link(stack.link[stack.size]);
    bool any_live = false;
    for (int g = 0; g < packet.group_count(); ++g) {
      travellers.live[g] = L::load(t_near + g * L::kWidth) <= packet.hit[g].t;
      any_live |= L::any(travellers.live[g]);
    }
    if (!any_live) continue;
    if (link.tag() != VolumeLink::kInner) {
      visit_leaf<Q>(bvh, travellers, link, stats);
      continue;
    }
    travellers.template count_live<Event::node_visit>(stats);
    const std::int32_t bottom = stack.size;
    const std::int32_t end = link.first + link.count();
    if (link.count() > kManyChildren) {
      for (std::int32_t c = link.first; c < end; ++c) push_if_met<kUniform>(bvh, travellers, octant, c, stack, stats);
      stack.sort(bottom);
      continue;
    }
    for (std::int32_t c = link.first; c < end; ++c) prefetch_target(bvh, bvh.link(c));
    for (std::int32_t c = link.first; c < end; ++c) {
      push_if_met<kUniform>(bvh, travellers, octant, c, stack, stats);
      stack.sink(bottom);
    }
  }
}

template <Query Q, class L, class Layout, class Stats>
void trace_by_stack(const BvhView<Layout>& bvh, const TraceArgs& args, Stats stats) noexcept {
  with_groups<L>(args.packet, [&]<int kGroups>() noexcept {
    BvhStack<L, kGroups> stack(args.scratch, bvh.stack_capacity, (args.packet + L::kWidth - 1) / L::kWidth);
    for_each_packet<Q, L, kGroups>(args, [&](Packet<L, kGroups>& packet) noexcept {
      with_signs<Layout>(packet,
                         [&]<bool kUniform>(std::int32_t octant) noexcept { traverse_by_stack<Q, kUniform, Layout>(bvh, stack, packet, octant, stats); });
    });
  });
}

template <class Layout>
template <Isa I, class Stats>
void BvhPacket<Layout>::Kernel<I, Stats>::closest(const BvhView<Layout>& bvh, const TraceArgs& args, Counters* counters) noexcept {
  trace_by_stack<Query::closest, Lanes<I>>(bvh, args, Stats(counters));
}

template <class Layout>
template <Isa I, class Stats>
void BvhPacket<Layout>::Kernel<I, Stats>::any(const BvhView<Layout>& bvh, const TraceArgs& args, Counters* counters) noexcept {
  trace_by_stack<Query::any, Lanes<I>>(bvh, args, Stats(counters));
}

}  // namespace raymeter
