#pragma once

// Traversal of the nearest node first (Kay, Kajiya 1986), for packets: a heap holds the nodes whose volumes some ray meets, keyed by the nearest entry of a ray
// that was live then. It ends when each ray's hit is nearer than the next node. A ray is live in a node that it meets while the node's key is not beyond its
// hit: for a packet of one ray that is the algorithm of 1986; in larger ones a ray may open a node that it would have left out alone.
//
// At any time the nodes in the heap are no ancestors of each other, so that there are never more than the tree has leaves.
// Events: node_visit when the children of an inner node are looked at, volume_test per child (the root's own volume counts too), leaf_visit when a leaf's
// primitives are tested.

#include "accel/bvh/heap_kernel.h"
#include "accel/volume_links_kernel.h"

namespace raymeter {

/// A binary heap, the least key first; on equal keys the order is that of the moves alone, so that it is the same everywhere.
template <class L>
struct BvhQueue {
  std::uint64_t* met;  // lanes of the packet that meet the volume
  float* key;
  std::int32_t* link;
  std::int32_t size = 0;

  BvhQueue(std::byte* scratch, std::int32_t capacity) noexcept
      : met(reinterpret_cast<std::uint64_t*>(scratch)), key(reinterpret_cast<float*>(met + capacity)), link(reinterpret_cast<std::int32_t*>(key + capacity)) {}

  void push(float new_key, std::int32_t new_link, std::uint64_t new_met) noexcept {
    std::int32_t at = size++;
    while (at > 0 && new_key < key[(at - 1) / 2]) {
      move((at - 1) / 2, at);
      at = (at - 1) / 2;
    }
    set(at, new_key, new_link, new_met);
  }
  void pop() noexcept {
    const std::int32_t last = --size;
    std::int32_t at = 0;
    for (std::int32_t child = 1; child < last; child = 2 * at + 1) {
      if (child + 1 < last && key[child + 1] < key[child]) ++child;
      if (!(key[child] < key[last])) break;
      move(child, at);
      at = child;
    }
    move(last, at);
  }

private:
  void set(std::int32_t at, float new_key, std::int32_t new_link, std::uint64_t new_met) noexcept {
    key[at] = new_key;
    link[at] = new_link;
    met[at] = new_met;
  }
  void move(std::int32_t from, std::int32_t to) noexcept { set(to, key[from], link[from], met[from]); }
};

template <bool kUniform, class Layout, class L, int kGroups, class Stats>
[[gnu::always_inline]] inline void enqueue_if_met(const BvhView<Layout>& bvh, const Travellers<Layout, L, kGroups>& travellers, std::int32_t octant,
                                                  std::int32_t c, BvhQueue<L>& queue, Stats stats) noexcept {
  using Float = typename L::Float;
  std::uint64_t met = 0;
  Float nearest(kInfinity);
  test_volume<kUniform>(bvh, travellers, octant, c, stats, [&](int g, typename L::Mask meets, Float entry) noexcept {
    nearest = L::min(L::select(meets, entry, Float(kInfinity)), nearest);
    met |= std::uint64_t{L::bits(meets)} << (g * L::kWidth);
  });
  if (met != 0) queue.push(L::reduce_min(nearest), c, met);
}

template <Query Q, bool kUniform, class Layout, class L, int kGroups, class Stats>
void traverse_by_heap(const BvhView<Layout>& bvh, BvhQueue<L>& queue, Packet<L, kGroups>& packet, std::int32_t octant, Stats stats) noexcept {
  using Float = typename L::Float;
  Travellers<Layout, L, kGroups> travellers(bvh.shared, packet);
  queue.size = 0;
  enqueue_if_met<kUniform>(bvh, travellers, octant, 0, queue, stats);
  while (queue.size > 0) {
    const Float key(queue.key[0]);
    const std::uint64_t met = queue.met[0];
    const VolumeLink& link = bvh.link(queue.link[0]);
    queue.pop();
    bool any_live = false, any_left = false;
    for (int g = 0; g < packet.group_count(); ++g) {
      const typename L::Mask nearer = key <= packet.hit[g].t;
      travellers.live[g] = nearer & L::mask(static_cast<std::uint32_t>(met >> (g * L::kWidth)));
      any_live |= L::any(travellers.live[g]);
      any_left |= L::any(nearer);
    }
    if (!any_left) return;
    if (!any_live) continue;
    if (link.tag() != VolumeLink::kInner) {
      visit_leaf<Q>(bvh, travellers, link, stats);
      continue;
    }
    travellers.template count_live<Event::node_visit>(stats);
    for (std::int32_t c = link.first; c < link.first + link.count(); ++c) enqueue_if_met<kUniform>(bvh, travellers, octant, c, queue, stats);
  }
}

template <Query Q, class L, class Layout, class Stats>
void trace_by_heap(const BvhView<Layout>& bvh, const TraceArgs& args, Stats stats) noexcept {
  BvhQueue<L> queue(args.scratch, bvh.heap_capacity);
  with_groups<L>(args.packet, [&]<int kGroups>() noexcept {
    for_each_packet<Q, L, kGroups>(args, [&](Packet<L, kGroups>& packet) noexcept {
      with_signs<Layout>(packet,
                         [&]<bool kUniform>(std::int32_t octant) noexcept { traverse_by_heap<Q, kUniform, Layout>(bvh, queue, packet, octant, stats); });
    });
  });
}

template <class Layout>
template <Isa I, class Stats>
void BvhHeap<Layout>::Kernel<I, Stats>::closest(const BvhView<Layout>& bvh, const TraceArgs& args, Counters* counters) noexcept {
  trace_by_heap<Query::closest, Lanes<I>>(bvh, args, Stats(counters));
}

template <class Layout>
template <Isa I, class Stats>
void BvhHeap<Layout>::Kernel<I, Stats>::any(const BvhView<Layout>& bvh, const TraceArgs& args, Counters* counters) noexcept {
  trace_by_heap<Query::any, Lanes<I>>(bvh, args, Stats(counters));
}

}  // namespace raymeter
