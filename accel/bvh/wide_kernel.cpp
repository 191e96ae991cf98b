// Beam traversal of an 8-wide hierarchy, front to back by the octant order of each node: a packet's beam is tested against eight children at once, its rays only
// at the boxes of leaves, and a leaf's triangles only where the beam meets them. Packets whose rays have no beam in common, or a wide one, test their rays at
// inner nodes too.
//
// Events: node_visit once per inner node, for all live lanes; volume_test per register of rays and box, and once per register of children that a beam is tested
// against, which counts for no lane; leaf_visit where a ray meets the leaf's box.

#include "accel/bvh/wide_kernel.h"

#include "accel/bvh/beam_kernel.h"
#include "core/bounds/slab_kernel.h"
#include "core/geometry/run_kernel.h"
#include "core/ray/packet_loop.h"
#include "core/stats/policy.h"

namespace raymeter {

namespace {

/// The lanes that meet the box in `place` before their hits.
template <class L, int kGroups, class Stats>
[[gnu::always_inline]] inline bool rays_meet(const WideNode& node, int place, const Packet<L, kGroups>& packet, typename L::Mask* lanes, Stats stats) noexcept {
  float box[6];
  for (int p = 0; p < 6; ++p) box[p] = node.plane[p][place];
  const BoxPlanes<L, false> planes(box, 0);
  bool any = false;
  for (int g = 0; g < packet.group_count(); ++g) {
    const auto live = packet.live(g);
    if constexpr (Stats::kCounting) {
      if (L::any(live)) stats.template count<Event::volume_test, L>(live);
    }
    const SlabInterval<L> interval = intersect_box(packet.ray[g], packet.hit[g].t, planes);
    lanes[g] = live & (interval.t_near <= interval.t_far);
    any |= L::any(lanes[g]);
  }
  return any;
}

/// Asks early for what lies behind the children that are met.
inline void prefetch_children(const WideBvhView& bvh, const WideNode& node, std::uint32_t met) noexcept {
  for (; met != 0; met &= met - 1) {
    const WideRef child = node.child[__builtin_ctz(met)];
    const void* target;
    switch (child.tag()) {
      case WideRef::Tag::inner: target = bvh.nodes + child.index(); break;
      case WideRef::Tag::block: target = bvh.blocks + child.index(); break;
      default: continue;
    }
    for (int line = 0; line < 4; ++line) __builtin_prefetch(static_cast<const char*>(target) + 64 * line);
  }
}

template <Query Q, class L, int kGroups, class Stats>
void test_block(const Beam& beam, float farthest, const TriangleBlock& block, const typename L::Mask* lanes, Packet<L, kGroups>& packet, Stats stats) noexcept {
  std::int32_t triangle[TriangleBlock::kTriangles];
  std::int32_t count = block.count;
  if (beam.axis >= 0) {
    count = triangles_met<L>(beam, block, farthest, triangle);
  } else {
    for (std::int32_t t = 0; t < count; ++t) triangle[t] = t;
  }
  const float* const column[3] = {block.vertex[0], block.vertex[1], block.vertex[2]};
  test_primitives<Q, L, kGroups>(packet, lanes, count, block.prim, ListedRefs{triangle}, stats, [&](const RayPacket<L>& ray, const HitPacket<L>&, std::int32_t t) noexcept {
    return intersect_triangle<L>(shear(ray, column, block.corner[0][t]), shear(ray, column, block.corner[1][t]), shear(ray, column, block.corner[2][t]));
  });
}

/// The octant whose order suits the packet: that of its first live ray.
template <class L, int kGroups>
inline std::uint32_t leading_octant(const Packet<L, kGroups>& packet) noexcept {
  for (int g = 0; g < packet.group_count(); ++g) {
    const std::uint32_t live = L::bits(packet.live(g));
    if (live == 0) continue;
    const std::uint32_t first = live & -live;
    std::uint32_t octant = 0;
    for (int a = 0; a < 3; ++a) octant |= ((L::bits(packet.ray[g].negative[a]) & first) != 0 ? 1u : 0u) << a;
    return octant;
  }
  return 0;
}

template <Query Q, class L, int kGroups, class Stats>
void traverse(const WideBvhView& bvh, std::uint32_t* stack, Packet<L, kGroups>& packet, Stats stats) noexcept {
  typename L::Mask lanes[Packet<L, kGroups>::kCapacity];
  const Beam beam = make_beam(packet, bvh.box);
  const bool has_beam = beam.axis >= 0;
  const std::uint32_t octant = leading_octant(packet);
  float farthest = has_beam ? farthest_plane(beam, packet) : kInfinity;
  std::int32_t size = 0;
  std::uint32_t index = 0;
  while (true) {
    const WideNode& node = bvh.nodes[index];
    if constexpr (Stats::kCounting) {
      for (int g = 0; g < packet.group_count(); ++g) {
        if (L::any(packet.live(g))) stats.template count<Event::node_visit, L>(packet.live(g));
      }
      for (int c = 0; has_beam && c < kWideChildren; c += L::kWidth) stats.template count<Event::volume_test, L>(L::mask(0));
    }
    std::uint32_t met = has_beam ? children_met<L>(beam, node, farthest) : (1u << kWideChildren) - 1;
    if (!beam.slim) {
      for (std::uint32_t left = met; left != 0; left &= left - 1) {
        const int place = __builtin_ctz(left);
        if (!rays_meet(node, place, packet, lanes, stats)) met &= ~(1u << place);
      }
    }
    prefetch_children(bvh, node, met);
    const std::uint32_t order = node.order[octant];
    for (int i = kWideChildren - 1; i >= 0; --i) {
      const std::uint32_t place = order >> 4 * i & 7;
      stack[size] = index * kWideChildren + place;
      size += static_cast<std::int32_t>(met >> place & 1);
    }
    while (true) {
      if (size == 0) return;
      const std::uint32_t entry = stack[--size];
      const WideNode& parent = bvh.nodes[entry / kWideChildren];
      const int place = static_cast<int>(entry % kWideChildren);
      if (has_beam && beam.sign * parent.plane[beam.first_row()][place] > farthest) continue;
      const WideRef child = parent.child[place];
      if (child.tag() == WideRef::Tag::inner) {
        index = child.index();
        break;
      }
      if (!rays_meet(parent, place, packet, lanes, stats)) continue;
      if constexpr (Stats::kCounting) {
        for (int g = 0; g < packet.group_count(); ++g) {
          if (L::any(lanes[g])) stats.template count<Event::leaf_visit, L>(lanes[g]);
        }
      }
      if (child.tag() == WideRef::Tag::block) test_block<Q>(beam, farthest, bvh.blocks[child.index()], lanes, packet, stats);
      else test_run<Q, L, kGroups>(packet, lanes, bvh.pools, bvh.runs[child.index()], nullptr, stats);
      if (has_beam) farthest = farthest_plane(beam, packet);
    }
  }
}

template <Query Q, class L, class Stats>
void trace(const WideBvhView& bvh, const TraceArgs& args, Stats stats) noexcept {
  auto* const stack = reinterpret_cast<std::uint32_t*>(args.scratch);
  with_groups<L>(args.packet, [&]<int kGroups>() noexcept {
    for_each_packet<Q, L, kGroups>(args, [&](Packet<L, kGroups>& packet) noexcept { traverse<Q, L, kGroups>(bvh, stack, packet, stats); });
  });
}

}  // namespace

template <Isa I, class Stats>
void WideBvhKernel<I, Stats>::closest(const WideBvhView& bvh, const TraceArgs& args, Counters* counters) noexcept {
  trace<Query::closest, Lanes<I>>(bvh, args, Stats(counters));
}

template <Isa I, class Stats>
void WideBvhKernel<I, Stats>::any(const WideBvhView& bvh, const TraceArgs& args, Counters* counters) noexcept {
  trace<Query::any, Lanes<I>>(bvh, args, Stats(counters));
}

template struct WideBvhKernel<kKernelIsa, NoStats>;
template struct WideBvhKernel<kKernelIsa, CountStats>;

}  // namespace raymeter
