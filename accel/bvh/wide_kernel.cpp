// Beam traversal of an 8-wide hierarchy, front to back by the octant order of each node: a packet's beam is tested against eight children at once, its rays
// only at the boxes of leaves, and a leaf's triangles only where the beam meets them. Packets whose rays have no beam in common, or a wide one, test their rays
// at inner nodes too.
//
// Events: node_visit once per inner node, for all live lanes; volume_test per register of rays and box, and per register of children (or beams) where a beam is
// tested, which counts for no lane but at packet = 1, where the beam is the ray: there a node is eight tests; leaf_visit where a ray meets the leaf's box.

#include "accel/bvh/wide_kernel.h"

#include "accel/bvh/beam_group_kernel.h"
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

template <Query Q, class L, int kGroups, class Stats>
void test_block(const Beam& beam, float farthest, const TriangleBlock& block, const typename L::Mask* lanes, Packet<L, kGroups>& packet, Stats stats) noexcept {
  const float* const column[3] = {block.vertex[0], block.vertex[1], block.vertex[2]};
  const auto test = [&]<bool kExpectHits>(const RayPacket<L>& ray, std::int32_t t) noexcept {
    return intersect_triangle<L, kExpectHits>(shear(ray, column, block.corner[0][t]), shear(ray, column, block.corner[1][t]),
                                              shear(ray, column, block.corner[2][t]));
  };
  using Ray = const RayPacket<L>&;
  using Hit = const HitPacket<L>&;
  if (beam.axis >= 0) {
    std::int32_t triangle[TriangleBlock::kTriangles];
    const std::int32_t count = triangles_met<L>(beam, block, farthest, triangle);
    test_primitives<Q, true>(packet, lanes, count, block.prim, ListedRefs{triangle}, stats,
                             [&](Ray ray, Hit, std::int32_t t) noexcept { return test.template operator()<true>(ray, t); });
  } else {
    test_primitives<Q, false>(packet, lanes, block.count, block.prim, PositionRefs{0}, stats,
                              [&](Ray ray, Hit, std::int32_t t) noexcept { return test.template operator()<false>(ray, t); });
  }
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

/// An entry of the stack: a child by its node and place, and the beams that meet it.
struct Entry {
  std::uint32_t child;
  std::uint32_t beams;
};

template <Query Q, class L, int kGroups, class Stats>
class Walk {
public:
  Walk(const WideBvhView& bvh, Entry* stack, BeamGroup<L, kGroups>& group, bool one_ray, Stats stats) noexcept
      : bvh_(bvh), stack_(stack), group_(group), one_ray_(one_ray), stats_(stats) {}

  /// Takes the beams `alive`, which have a slim beam in common unless there is only one, through the hierarchy.
  void run(std::uint32_t alive) noexcept {
    octant_ = leading_octant(group_.rays[__builtin_ctz(alive)]);
    std::int32_t size = 0;
    std::uint32_t index = 0;
    while (true) {
      size = open(index, alive, size);
      while (true) {
        if (size == 0) return;
        const Entry entry = stack_[--size];
        const WideNode& parent = bvh_.nodes[entry.child / kWideChildren];
        const int place = static_cast<int>(entry.child % kWideChildren);
        alive = still_wanted(parent, place, entry.beams);
        if (alive == 0) continue;
        const WideRef child = parent.child[place];
        if (child.tag() == WideRef::Tag::inner) {
          index = child.index();
          break;
        }
        for (; alive != 0; alive &= alive - 1) test_leaf(parent, place, __builtin_ctz(alive));
      }
    }
  }

private:
  static bool alone(std::uint32_t beams) noexcept { return (beams & (beams - 1)) == 0; }

  /// Puts the children of a node that any of the beams meets on the stack, the nearest last. Returns the stack's new size.
  std::int32_t open(std::uint32_t index, std::uint32_t alive, std::int32_t size) noexcept {
    const WideNode& node = bvh_.nodes[index];
    std::uint32_t beams[kWideChildren];
    const std::uint32_t met = alone(alive) ? children_of_one(node, __builtin_ctz(alive), beams) : children_of_group(node, alive, beams);
    const std::uint32_t order = node.order[octant_];
    for (int i = kWideChildren - 1; i >= 0; --i) {
      const std::uint32_t place = order >> 4 * i & 7;
      stack_[size] = {index * kWideChildren + place, beams[place]};
      size += static_cast<std::int32_t>(met >> place & 1);
    }
    return size;
  }
  std::uint32_t children_of_one(const WideNode& node, int p, std::uint32_t* beams) noexcept {
    const Packet<L, kGroups>& packet = group_.rays[p];
    const Beam& beam = group_.beam[p];
    count_visit(packet);
    for (int c = 0; c < kWideChildren; ++c) beams[c] = 1u << p;
    std::uint32_t met = (1u << kWideChildren) - 1;
    if (beam.axis >= 0) {
      count_beam_tests(kWideChildren);
      met = children_met<L>(beam, node, group_.farthest[p]);
      if (beam.slim) return met;
    }
    typename L::Mask lanes[Packet<L, kGroups>::kCapacity];
    for (std::uint32_t left = met; left != 0; left &= left - 1) {
      const int place = __builtin_ctz(left);
      if (!rays_meet(node, place, packet, lanes, stats_)) met &= ~(1u << place);
    }
    return met;
  }
  std::uint32_t children_of_group(const WideNode& node, std::uint32_t alive, std::uint32_t* beams) noexcept {
    if constexpr (Stats::kCounting) {
      for (std::uint32_t left = alive; left != 0; left &= left - 1) count_visit(group_.rays[__builtin_ctz(left)]);
    }
    count_beam_tests(kWideChildren);
    std::uint32_t met = children_met<L>(group_.whole, node, group_.farthest_of_all());
    for (std::uint32_t left = met; left != 0; left &= left - 1) {
      const int place = __builtin_ctz(left);
      count_beam_tests(kMaxBeams);
      beams[place] = beams_met(group_, node, place, alive);
      if (beams[place] == 0) met &= ~(1u << place);
    }
    return met;
  }
  /// The beams of an entry that its box may still give something: their hits may have come nearer since.
  [[nodiscard]] std::uint32_t still_wanted(const WideNode& parent, int place, std::uint32_t beams) const noexcept {
    using Float = typename L::Float;
    if (alone(beams)) {
      const int p = __builtin_ctz(beams);
      const Beam& beam = group_.beam[p];
      return beam.axis >= 0 && beam.sign * parent.plane[beam.first_row()][place] > group_.farthest[p] ? 0 : beams;
    }
    const Float first(group_.whole.sign * parent.plane[group_.whole.first_row()][place]);
    std::uint32_t nearer = 0;
    for (int p = 0; p < kMaxBeams; p += L::kWidth) nearer |= L::bits(first <= L::load(group_.farthest + p)) << p;
    return nearer & beams;
  }
  void test_leaf(const WideNode& parent, int place, int p) noexcept {
    Packet<L, kGroups>& packet = group_.rays[p];
    typename L::Mask lanes[Packet<L, kGroups>::kCapacity];
    if (!rays_meet(parent, place, packet, lanes, stats_)) return;
    if constexpr (Stats::kCounting) {
      for (int g = 0; g < packet.group_count(); ++g) {
        if (L::any(lanes[g])) stats_.template count<Event::leaf_visit, L>(lanes[g]);
      }
    }
    const WideRef child = parent.child[place];
    if (child.tag() == WideRef::Tag::block)
      test_block<Q>(group_.beam[p], group_.farthest[p], bvh_.blocks[child.index()], lanes, packet, stats_);
    else
      test_run<Q, L, kGroups>(packet, lanes, bvh_.pools, bvh_.runs[child.index()], nullptr, stats_);
    group_.update_farthest(p);
  }
  void count_visit(const Packet<L, kGroups>& packet) noexcept {
    if constexpr (Stats::kCounting) {
      for (int g = 0; g < packet.group_count(); ++g) {
        if (L::any(packet.live(g))) stats_.template count<Event::node_visit, L>(packet.live(g));
      }
    }
  }
  void count_beam_tests(int tests) noexcept {
    if constexpr (Stats::kCounting) {
      const int step = one_ray_ ? 1 : L::kWidth;
      for (int t = 0; t < tests; t += step) stats_.template count<Event::volume_test, L>(L::mask(one_ray_ ? 1 : 0));
    }
  }

  const WideBvhView& bvh_;
  Entry* stack_;
  BeamGroup<L, kGroups>& group_;
  bool one_ray_;
  Stats stats_;
  std::uint32_t octant_ = 0;
};

template <Query Q, class L, class Stats>
void trace(const WideBvhView& bvh, const TraceArgs& args, Stats stats) noexcept {
  auto* const stack = reinterpret_cast<Entry*>(args.scratch);
  const auto at_most = [](std::int32_t count, std::int32_t most) noexcept { return count < most ? count : most; };
  with_groups<L>(at_most(args.packet, kBeamRays), [&]<int kGroups>() noexcept {
    BeamGroup<L, kGroups> group;
    for (std::int32_t first = 0; first < args.rays.count; first += args.packet) {
      const std::int32_t count = at_most(args.rays.count - first, args.packet);
      group.count = 0;
      for (std::int32_t b = 0; b < count; b += kBeamRays) load_packet(args.rays, first + b, at_most(count - b, kBeamRays), group.rays[group.count++]);
      Walk<Q, L, kGroups, Stats> walk(bvh, stack, group, args.packet == 1, stats);
      if (group.make_beams(bvh.box))
        walk.run(group.alive);
      else
        for (std::uint32_t left = group.alive; left != 0; left &= left - 1) walk.run(left & -left);
      for (std::int32_t b = 0; b < count; b += kBeamRays) store_packet<Q>(args, first + b, at_most(count - b, kBeamRays), group.rays[b / kBeamRays]);
    }
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
