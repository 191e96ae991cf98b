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

template <class L, int kGroups>
struct Stack {
  float* near_column;  // [entry][group][lane]
  float* key;          // [entry]: the entry distance of one lane, to order siblings by
  std::int32_t* link;  // [entry]
  std::int32_t group_count;
  std::int32_t size = 0;

  Stack(const TraceArgs& args, std::int32_t capacity, std::int32_t groups) noexcept
      : near_column(reinterpret_cast<float*>(args.scratch)),
        key(near_column + static_cast<std::int64_t>(capacity) * kMaxPacket),
        link(reinterpret_cast<std::int32_t*>(key + capacity)),
        group_count(groups) {}
  [[nodiscard]] float* near_of(std::int32_t entry, int group) const noexcept {
    const int groups = kGroups > 0 ? kGroups : group_count;
    return near_column + (static_cast<std::int64_t>(entry) * groups + group) * L::kWidth;
  }
};

/// Pushes link `c` where any live lane meets its box.
template <class L, int kGroups, bool kUniform, class Stats>
inline bool push_if_met(const BvhView& bvh, const Packet<L, kGroups>& packet, const typename L::Mask* live, std::int32_t c, Stack<L, kGroups>& stack,
                        Stats stats) noexcept {
  using Float = typename L::Float;
  bool met = false;
  for (int g = 0; g < packet.group_count(); ++g) {
    float* const out = stack.near_of(stack.size, g);
    if (kGroups != 1 && L::none(live[g])) {
      L::store(out, Float(kInfinity));
      continue;
    }
    stats.template count<Event::volume_test, L>(live[g]);
    const SlabInterval<L> interval = intersect_box<L, kUniform>(packet.ray[g], packet.hit[g].t, bvh.links[c].box);
    const typename L::Mask meets = live[g] & (interval.t_near <= interval.t_far);
    L::store(out, L::select(meets, interval.t_near, Float(kInfinity)));
    if (met) continue;
    const std::uint32_t bits = L::bits(meets);
    if (bits == 0) continue;
    met = true;
    stack.key[stack.size] = out[__builtin_ctz(bits)];
  }
  if (!met) return false;
  stack.link[stack.size++] = c;
  return true;
}

/// Moves the last entry below those that are nearer, down to `bottom`: the nearest is to be on top.
template <class L, int kGroups>
inline void sort_in(Stack<L, kGroups>& stack, std::int32_t bottom) noexcept {
  const int groups = kGroups > 0 ? kGroups : stack.group_count;
  for (std::int32_t e = stack.size - 1; e > bottom && stack.key[e] > stack.key[e - 1]; --e) {
    const float lower_key = stack.key[e - 1];
    stack.key[e - 1] = stack.key[e];
    stack.key[e] = lower_key;
    const std::int32_t lower_link = stack.link[e - 1];
    stack.link[e - 1] = stack.link[e];
    stack.link[e] = lower_link;
    for (int g = 0; g < groups; ++g) {
      const auto upper = L::load(stack.near_of(e, g));
      L::store(stack.near_of(e, g), L::load(stack.near_of(e - 1, g)));
      L::store(stack.near_of(e - 1, g), upper);
    }
  }
}

template <Query Q, class L, int kGroups, bool kUniform, class Stats>
void traverse(const BvhView& bvh, const TraceArgs& args, Packet<L, kGroups>& packet, Stats stats) noexcept {
  using Mask = typename L::Mask;
  Mask live[Packet<L, kGroups>::kCapacity];
  Stack<L, kGroups> stack(args, bvh.stack_capacity, packet.group_count());
  for (int g = 0; g < packet.group_count(); ++g) live[g] = packet.live(g);
  push_if_met<L, kGroups, kUniform>(bvh, packet, live, 0, stack, stats);

  while (stack.size > 0) {
    const std::int32_t entry = --stack.size;
    bool any_live = false;
    for (int g = 0; g < packet.group_count(); ++g) {
      const auto t_near = L::load(stack.near_of(entry, g));
      live[g] = (t_near <= packet.hit[g].t) & (t_near < typename L::Float(kInfinity));
      any_live = any_live || L::any(live[g]);
    }
    if (!any_live) continue;
    const BvhLink& link = bvh.links[stack.link[entry]];
    if (link.tag() == BvhLink::kInner) {
      if constexpr (Stats::kCounting) {
        for (int g = 0; g < packet.group_count(); ++g) {
          if (L::any(live[g])) stats.template count<Event::node_visit, L>(live[g]);
        }
      }
      const std::int32_t bottom = stack.size;
      for (std::int32_t c = link.first; c < link.first + link.count(); ++c) {
        if (push_if_met<L, kGroups, kUniform>(bvh, packet, live, c, stack, stats)) sort_in(stack, bottom);
      }
      continue;
    }
    if constexpr (Stats::kCounting) {
      for (int g = 0; g < packet.group_count(); ++g) {
        if (L::any(live[g])) stats.template count<Event::leaf_visit, L>(live[g]);
      }
    }
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
    for_each_packet<Q, L, kGroups>(args, [&](Packet<L, kGroups>& packet) noexcept {
      if (packet.shares_octant()) traverse<Q, L, kGroups, true>(bvh, args, packet, stats);
      else traverse<Q, L, kGroups, false>(bvh, args, packet, stats);
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
