// Packet traversal of a bounding volume hierarchy: all rays of a packet descend together (Wald et al. 2001, Boulos et al. 2006), each lane culled by its own
// entry distance, so that a lane opens a node exactly when a lone ray would in this order; with packet = 1 the order is nearest child first.
//
// A stack entry is a link and the distance at which each lane enters its box, infinite where the lane misses it. A lane is live in an entry while that distance
// is not beyond its hit. Events: node_visit when the children of an inner node are looked at, volume_test per child (the root's own box counts too), leaf_visit
// when a leaf's primitives are tested.

#include "accel/bvh/packet_kernel.h"

#include "core/bounds/slab_kernel.h"
#include "core/geometry/run_kernel.h"
#include "core/ray/packet_loop.h"
#include "core/stats/policy.h"

namespace raymeter {

namespace {

/// The entry distance of a lane that misses: not below anything.
inline constexpr float kMissed = __builtin_nanf("");

/// Entries of the traversal stack. An entry's distances stand in a row of their own, [group][lane]; entries change places without moving rows: `row` is a
/// permutation of all rows, of which those at `size` and above are free.
template <class L, int kGroups>
struct Stack {
  float* distances;
  float* key;          // the entry distance of one lane, to order siblings by
  std::int32_t* link;
  std::int32_t* row;
  std::int32_t row_floats;
  std::int32_t size = 0;

  Stack(std::byte* scratch, std::int32_t capacity, std::int32_t groups) noexcept
      : distances(reinterpret_cast<float*>(scratch)),
        key(distances + static_cast<std::int64_t>(capacity) * kMaxPacket),
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
};

/// Asks early for what a link leads to: large trees do not fit the caches, and a packet waits longer for memory than it computes.
inline void prefetch_target(const BvhView& bvh, const BvhLink& link) noexcept {
  if (link.tag() == BvhLink::kInner) {
    __builtin_prefetch(&bvh.links[link.first]);
  } else if (link.tag() == static_cast<std::uint32_t>(PrimKind::triangle)) {
    const float* const record = bvh.pools.triangles.vertex[0][0] + static_cast<std::int64_t>(link.first) * bvh.pools.triangles.stride;
    __builtin_prefetch(record);
    __builtin_prefetch(record + 16);
  }
}

/// Pushes link `c` where any live lane meets its box, below its siblings that are nearer; those begin at `bottom`.
template <class L, int kGroups, bool kUniform, class Stats>
[[gnu::always_inline]] inline void push_if_met(const BvhView& bvh, const Packet<L, kGroups>& packet, std::int32_t octant, const typename L::Mask* live,
                                               std::int32_t c, std::int32_t bottom, Stack<L, kGroups>& stack, Stats stats) noexcept {
  using Float = typename L::Float;
  const BvhLink& link = bvh.links[c];
  const BoxPlanes<L, kUniform> planes(link.box, octant);
  float* const out = stack.distances_of(stack.size);
  std::uint64_t met = 0;
  for (int g = 0; g < packet.group_count(); ++g) {
    if (kGroups != 1 && L::none(live[g])) {
      L::store(out + g * L::kWidth, Float(kMissed));
      continue;
    }
    stats.template count<Event::volume_test, L>(live[g]);
    const SlabInterval<L> interval = intersect_box(packet.ray[g], packet.hit[g].t, planes);
    const typename L::Mask meets = live[g] & (interval.t_near <= interval.t_far);
    L::store(out + g * L::kWidth, L::select(meets, interval.t_near, Float(kMissed)));
    met |= std::uint64_t{L::bits(meets)} << (g * L::kWidth);
  }
  if (met == 0) return;
  std::int32_t e = stack.size++;
  stack.key[e] = out[__builtin_ctzll(met)];
  stack.link[e] = c;
  for (; e > bottom && stack.key[e] > stack.key[e - 1]; --e) stack.swap(e, e - 1);
}

template <Query Q, class L, int kGroups, bool kUniform, class Stats>
void traverse(const BvhView& bvh, Stack<L, kGroups>& stack, Packet<L, kGroups>& packet, std::int32_t octant, Stats stats) noexcept {
  using Mask = typename L::Mask;
  Mask live[Packet<L, kGroups>::kCapacity];
  for (int g = 0; g < packet.group_count(); ++g) live[g] = packet.live(g);
  const auto count_live = [&]<Event e>() noexcept {
    if constexpr (Stats::kCounting) {
      for (int g = 0; g < packet.group_count(); ++g) {
        if (L::any(live[g])) stats.template count<e, L>(live[g]);
      }
    }
  };
  push_if_met<L, kGroups, kUniform>(bvh, packet, octant, live, 0, 0, stack, stats);
  while (stack.size > 0) {
    const float* const t_near = stack.distances_of(--stack.size);
    const BvhLink& link = bvh.links[stack.link[stack.size]];
    bool any_live = false;
    for (int g = 0; g < packet.group_count(); ++g) {
      live[g] = L::load(t_near + g * L::kWidth) <= packet.hit[g].t;
      any_live |= L::any(live[g]);
    }
    if (!any_live) continue;
    if (link.tag() == BvhLink::kInner) {
      count_live.template operator()<Event::node_visit>();
      const std::int32_t bottom = stack.size;
      for (std::int32_t c = link.first; c < link.first + link.count(); ++c) prefetch_target(bvh, bvh.links[c]);
      for (std::int32_t c = link.first; c < link.first + link.count(); ++c) {
        push_if_met<L, kGroups, kUniform>(bvh, packet, octant, live, c, bottom, stack, stats);
      }
      continue;
    }
    count_live.template operator()<Event::leaf_visit>();
    if (link.tag() == BvhLink::kRuns) {
      for (std::int32_t r = link.first; r < link.first + link.count(); ++r) {
        test_run<Q, L, kGroups>(packet, live, bvh.pools, bvh.runs[r], nullptr, stats);
      }
    } else {
      test_run<Q, L, kGroups>(packet, live, bvh.pools, PrimitiveRun{link.tag_and_count, link.first}, nullptr, stats);
    }
  }
}

template <Query Q, class L, class Stats>
void trace(const BvhView& bvh, const TraceArgs& args, Stats stats) noexcept {
  with_groups<L>(args.packet, [&]<int kGroups>() noexcept {
    Stack<L, kGroups> stack(args.scratch, bvh.stack_capacity, (args.packet + L::kWidth - 1) / L::kWidth);
    for_each_packet<Q, L, kGroups>(args, [&](Packet<L, kGroups>& packet) noexcept {
      const std::int32_t octant = packet.shared_octant();
      if (octant >= 0) traverse<Q, L, kGroups, true>(bvh, stack, packet, octant, stats);
      else traverse<Q, L, kGroups, false>(bvh, stack, packet, octant, stats);
    });
  });
}

}  // namespace

template <Isa I, class Stats>
void BvhPacketKernel<I, Stats>::closest(const BvhView& bvh, const TraceArgs& args, Counters* counters) noexcept {
  trace<Query::closest, Lanes<I>>(bvh, args, Stats(counters));
}

template <Isa I, class Stats>
void BvhPacketKernel<I, Stats>::any(const BvhView& bvh, const TraceArgs& args, Counters* counters) noexcept {
  trace<Query::any, Lanes<I>>(bvh, args, Stats(counters));
}

template struct BvhPacketKernel<kKernelIsa, NoStats>;
template struct BvhPacketKernel<kKernelIsa, CountStats>;

}  // namespace raymeter
