// Stream traversal of an 8-wide hierarchy, for rays that have little in common: those of a slice are sorted by octant and by the axis of their largest |dir|,
// and groups of up to 64 descend together, each node being fetched once for all of a group's rays that want it. An entry of the stack is a child and its rays.
//
// Events: node_visit once per inner node, for all rays that want it; volume_test eight per such ray, by registers of children; leaf_visit for the rays that
// want a leaf; prim_test per ray and triangle of the leaf, by registers of triangles, or of rays for other primitives.

#include "accel/bvh/stream_kernel.h"

#include "accel/bvh/stream_block_kernel.h"
#include "accel/bvh/stream_count_kernel.h"
#include "accel/bvh/stream_node_kernel.h"
#include "accel/bvh/stream_sphere_kernel.h"
#include "accel/bvh/stream_stack_kernel.h"
#include "core/geometry/run_kernel.h"
#include "core/simd/select_kernel.h"
#include "core/stats/policy.h"

namespace raymeter {

namespace {

template <Query Q, class L, class Stats>
[[gnu::always_inline]] inline void test_block_of_group(const TriangleBlock& block, std::uint64_t rays, StreamGroup<L>& group, Stats stats) noexcept {
  const StreamAxes axes = group.axes;
  const BlockTriangles<L> triangles(block, axes);
  std::uint64_t blocked = 0;
  for (; rays != 0; rays &= rays - 1) {
    const int i = __builtin_ctzll(rays);
    StreamRay& ray = group.ray[i];
    if constexpr (Q == Query::any) {
      const std::uint32_t blockers = blockers_of_block<L>(ray, axes, block, triangles, stats);
      const int some = __builtin_ctz(blockers | 1u << (TriangleBlock::kTriangles - 1));
      group.prim[i] = select_unforeseen(blockers != 0, block.prim[some], group.prim[i]);
      blocked |= select_unforeseen(blockers != 0, rays & -rays, std::uint64_t{0});
    } else {
      RayHit hit{-ray.interval[1], group.prim[i], 0, 0};
      if (!nearest_of_block<L>(ray, axes, block, triangles, hit, stats)) continue;
      group.prim[i] = hit.prim;
      ray.interval[1] = -hit.t;
      group.u[i] = hit.u;
      group.v[i] = hit.v;
    }
  }
  group.alive &= ~blocked;
}

template <Query Q, class L, class Stats>
[[gnu::always_inline]] inline void test_spheres_of_group(const SphereView& pool, PrimitiveRun run, std::uint64_t rays, StreamGroup<L>& group,
                                                         Stats stats) noexcept {
  const std::int32_t* const prim = pool.prim + run.first;
  std::uint64_t blocked = 0;
  for (; rays != 0; rays &= rays - 1) {
    const int i = __builtin_ctzll(rays);
    StreamRay& ray = group.ray[i];
    const RayHit before{-ray.interval[1], group.prim[i], 0, 0};
    RayHit hit = before;
    meet_spheres<L, Q == Query::closest>(ray, group.line[i], group.octant, pool, run, stats, [&](const LeafHits<L>& found) noexcept {
      if constexpr (Q == Query::any) {
        if (found.closer == 0) return;
        stats.template count<Event::prim_hit, L>(L::mask(found.closer));
        hit.prim = prim[found.first + __builtin_ctz(found.closer)];
      } else {
        take_nearest<L>(found, prim, before, hit, stats);
      }
    });
    if (hit.prim == before.prim) continue;
    group.prim[i] = hit.prim;
    if constexpr (Q == Query::any) {
      blocked |= rays & -rays;
    } else {
      ray.interval[1] = -hit.t;
      group.u[i] = group.v[i] = 0;
    }
  }
  group.alive &= ~blocked;
}

/// Other primitives, rays in lanes.
template <Query Q, class L, class Stats>
[[gnu::always_inline]] inline void test_run_of_group(const WideBvhView& bvh, PrimitiveRun run, std::uint64_t rays, StreamGroup<L>& group,
                                                     Stats stats) noexcept {
  constexpr std::uint64_t kAll = (1u << L::kWidth) - 1;
  typename L::Mask lanes[Packet<L, 0>::kCapacity];
  for (int g = 0; g < group.packet.group_count(); ++g) {
    lanes[g] = L::mask(static_cast<std::uint32_t>(rays >> g * L::kWidth & kAll));
    if (L::any(lanes[g])) group.to_packet(g);
  }
  test_run<Q, L, 0>(group.packet, lanes, bvh.pools, run, nullptr, stats);
  for (int g = 0; g < group.packet.group_count(); ++g) {
    if (L::none(lanes[g])) continue;
    group.from_packet(g);
    if constexpr (Q == Query::any) group.alive &= ~(std::uint64_t{L::bits(~group.packet.live(g) & lanes[g])} << g * L::kWidth);
  }
}

/// A group on its way through the hierarchy.
template <class L>
struct Descent {
  StreamStack stack;
  std::int32_t first;  ///< of its rays, in the sorted slice
  WideRef child;       ///< what it has come to, and the rays that want it
  std::uint64_t rays;
  StreamGroup<L> group;
};

template <Query Q, class View, class L, class Stats>
[[gnu::always_inline]] inline void open_node(const View& bvh, Descent<L>& at, Stats stats) noexcept {
  WideNode room;
  const WideNode& node = node_at<L>(bvh, at.child.index(), at.group.order, room);
  count_node<L>(at.rays, stats);
  push_children<L>(at.stack, node, node.order[at.group.order], rays_of_children<L>(node, at.group.octant, at.group.ray, at.rays));
}

template <Query Q, class L, class Stats>
[[gnu::always_inline]] inline void test_leaf(const WideBvhView& bvh, const RayView& rays_of_slice, const std::int32_t* source, Descent<L>& at,
                                             Stats stats) noexcept {
  count_rays<Event::leaf_visit, L>(at.rays, stats);
  if (at.child.tag() == WideRef::Tag::block) [[likely]] {
    test_block_of_group<Q>(bvh.blocks[at.child.index()], at.rays, at.group, stats);
  } else if (const PrimitiveRun run = bvh.runs[at.child.index()]; run.kind() == PrimKind::sphere) {
    test_spheres_of_group<Q>(bvh.pools.spheres, run, at.rays, at.group, stats);
  } else {
    at.group.load_rays(rays_of_slice, source + at.first);
    test_run_of_group<Q>(bvh, run, at.rays, at.group, stats);
  }
}

/// Takes each group one child further. What a child is no branch foresees: those that have come to nodes go first, then those that have come to leaves.
template <Query Q, class View, class L, class Stats>
[[gnu::always_inline]] inline void step(const View& bvh, const RayView& rays_of_slice, const std::int32_t* source, Descent<L>* const* descent, int count,
                                        Stats stats) noexcept {
  std::uint32_t at_nodes = 0, at_leaves = 0;
  for (int g = 0; g < count; ++g) {
    Descent<L>& at = *descent[g];
    --at.stack.size;
    at.child = at.stack.child[at.stack.size];
    at.rays = at.stack.rays[at.stack.size] & (Q == Query::any ? at.group.alive : ~std::uint64_t{0});
    const std::uint32_t wanted = at.rays != 0 ? 1u : 0u, is_node = at.child.tag() == WideRef::Tag::inner ? 1u : 0u;
    at_nodes |= (wanted & is_node) << g;
    at_leaves |= (wanted & ~is_node) << g;
  }
  for (; at_nodes != 0; at_nodes &= at_nodes - 1) {
    Descent<L>& at = *descent[__builtin_ctz(at_nodes)];
    open_node<Q>(bvh, at, stats);
    if (at.stack.size > 0) prefetch_child(bvh, at.stack.child[at.stack.size - 1]);
  }
  for (; at_leaves != 0; at_leaves &= at_leaves - 1) {
    Descent<L>& at = *descent[__builtin_ctz(at_leaves)];
    if (at.stack.size > 0) prefetch_child(bvh, at.stack.child[at.stack.size - 1]);
    test_leaf<Q>(bvh, rays_of_slice, source, at, stats);
  }
}

/// Puts a group's hits where its rays came from.
template <Query Q, class L>
void store_group(const TraceArgs& args, const std::int32_t* source, const float* t_unit, const StreamGroup<L>& group) noexcept {
  for (std::int32_t i = 0; i < group.count; ++i) {
    const std::int32_t to = source[i];
    const bool missed = group.prim[i] == kNoPrim;
    if constexpr (Q == Query::any) {
      args.blocker[to] = select_unforeseen(missed, -1, group.prim[i]);
    } else {
      args.hits.t[to] = missed ? kInfinity : -group.ray[i].interval[1] * t_unit[i];
      args.hits.prim[to] = missed ? -1 : group.prim[i];
      args.hits.u[to] = group.u[i];
      args.hits.v[to] = group.v[i];
    }
  }
}

/// A slice's part of at most kStreamRays rays.
TraceArgs part_of(const TraceArgs& args, std::int32_t first, std::int32_t count) noexcept {
  TraceArgs part = args;
  for (int a = 0; a < 3; ++a) {
    part.rays.org[a] += first;
    part.rays.dir[a] += first;
  }
  part.rays.t_min += first;
  part.rays.t_max += first;
  part.rays.count = count;
  if (args.blocker != nullptr) {
    part.blocker += first;
  } else {
    part.hits.t += first;
    part.hits.prim += first;
    part.hits.u += first;
    part.hits.v += first;
  }
  return part;
}

/// Cuts sorted rays into groups of one bin and nearly the same size, `most` at most.
struct GroupCutter {
  const std::int32_t* first_of_bin;
  std::int32_t most;
  std::uint32_t bin = 0;
  std::int32_t first = 0;
  std::int32_t count = 0;

  bool next() noexcept {
    first += count;
    while (bin < kStreamBins && first == first_of_bin[bin + 1]) ++bin;
    if (bin == kStreamBins) return false;
    const std::int32_t left = first_of_bin[bin + 1] - first;
    const std::int32_t groups = (left + most - 1) / most;
    count = (left + groups - 1) / groups;
    return true;
  }
};

template <Query Q, class L, class View, class Stats>
void trace_slice(const View& bvh, const TraceArgs& args, SortedRays& sorted, std::byte* stacks, Stats stats) noexcept {
  sort_by_bin<L>(args.rays, bvh.pools.spheres.prim != nullptr, sorted);
  GroupCutter cutter{sorted.first, args.packet};
  Descent<L> descents[kInterleaved];
  Descent<L>* active[kInterleaved];
  int count = 0;
  // Rays that part little, as those to a light, are blocked far from what they leave more often than near it. What parts is blocked near, while together.
  const auto far_first = [&](std::uint32_t bin) noexcept { return 2 * (sorted.first[bin + 1] - sorted.first[bin]) > args.rays.count; };
  // Starts the next group that has anything to trace.
  const auto start = [&](Descent<L>& at) noexcept {
    while (cutter.next()) {
      at.first = cutter.first;
      at.group.start(sorted, cutter.first, cutter.count, cutter.bin);
      if (Q == Query::any && far_first(cutter.bin)) at.group.order ^= 7;
      if (at.group.alive != 0) {
        at.stack.size = 0;
        at.stack.push(WideRef(WideRef::Tag::inner, 0), at.group.alive);
        return true;
      }
      store_group<Q>(args, sorted.source + at.first, sorted.t_unit + at.first, at.group);
    }
    return false;
  };
  for (int g = 0; g < kInterleaved; ++g) {
    descents[g].stack = StreamStack(stacks + static_cast<std::size_t>(g) * stream_stack_bytes(bvh.stack_capacity), bvh.stack_capacity);
    if (count == g && start(descents[g])) active[count++] = &descents[g];
  }
  while (count > 0) {
    step<Q>(bvh, args.rays, sorted.source, active, count, stats);
    for (int g = count - 1; g >= 0; --g) {
      Descent<L>& at = *active[g];
      if (at.stack.size > 0) continue;
      store_group<Q>(args, sorted.source + at.first, sorted.t_unit + at.first, at.group);
      if (!start(at)) active[g] = active[--count];
    }
  }
}

template <Query Q, class L, class View, class Stats>
void trace(const View& bvh, const TraceArgs& args, Stats stats) noexcept {
  SortedRays& sorted = *reinterpret_cast<SortedRays*>(args.scratch);
  for (std::int32_t begin = 0; begin < args.rays.count; begin += kStreamRays) {
    const std::int32_t left = args.rays.count - begin;
    trace_slice<Q, L>(bvh, part_of(args, begin, left < kStreamRays ? left : kStreamRays), sorted, args.scratch + sizeof(SortedRays), stats);
  }
}

}  // namespace

template <Isa I, class Stats>
void StreamKernel<I, Stats>::closest(const WideBvhView& bvh, const TraceArgs& args, Counters* counters) noexcept {
  trace<Query::closest, Lanes<I>>(bvh, args, Stats(counters));
}

template <Isa I, class Stats>
void StreamKernel<I, Stats>::any(const WideBvhView& bvh, const TraceArgs& args, Counters* counters) noexcept {
  trace<Query::any, Lanes<I>>(bvh, args, Stats(counters));
}

template <Isa I, class Stats>
void StreamKernel<I, Stats>::closest(const QuantisedBvhView& bvh, const TraceArgs& args, Counters* counters) noexcept {
  trace<Query::closest, Lanes<I>>(bvh, args, Stats(counters));
}

template <Isa I, class Stats>
void StreamKernel<I, Stats>::any(const QuantisedBvhView& bvh, const TraceArgs& args, Counters* counters) noexcept {
  trace<Query::any, Lanes<I>>(bvh, args, Stats(counters));
}

template struct StreamKernel<kKernelIsa, NoStats>;
template struct StreamKernel<kKernelIsa, CountStats>;

}  // namespace raymeter
