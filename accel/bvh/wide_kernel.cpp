// Beam traversal of an 8-wide hierarchy, front to back by the octant order of each node: a beam is tested against eight children at once, its rays only at the
// boxes of leaves, and a leaf's triangles only where the beam meets them. Beams go down in groups until each is alone. Rays that have no beam in common, or a
// wide one, are tested at inner nodes too.
//
// Events: node_visit once per inner node, for all live lanes; volume_test per register of rays and box, and per register of children (or beams) where a beam is
// tested, which counts for no lane but at packet = 1, where the beam is the ray: there a node is eight tests; leaf_visit where a ray meets the leaf's box.

#include "accel/bvh/wide_kernel.h"

#include "accel/bvh/beam_block_kernel.h"
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
class Walk {
public:
  Walk(const WideBvhView& bvh, BeamEntry* stack, BeamGroup<L, kGroups>& group, bool one_ray, Stats stats) noexcept
      : bvh_(bvh), stack_(stack), group_(group), one_ray_(one_ray), stats_(stats) {}

  /// Takes the beams `alive`, which have a beam in common, through the hierarchy together as long as they meet the same nodes.
  void run_group(std::uint32_t alive) noexcept {
    octant_ = leading_octant(group_.rays[__builtin_ctz(alive)]);
    if (alone(alive)) return run_one(0, __builtin_ctz(alive), 0);
    std::int32_t size = open(0, alive, 0);
    // A leaf waits while the next entry is looked at, a node perhaps: by then it has come from memory.
    BeamEntry waiting{};
    const auto test_waiting = [&]() noexcept {
      for (std::uint32_t left = waiting.beams & group_.reach(waiting.first); left != 0; left &= left - 1) test_leaf(waiting, __builtin_ctz(left));
      waiting.beams = 0;
    };
    while (size > 0) {
      const BeamEntry entry = stack_[--size];
      const std::uint32_t beams = entry.beams & group_.reach(entry.first);
      if (beams == 0) continue;
      if (entry.child.tag() != WideRef::Tag::inner) {
        test_waiting();
        waiting = entry;
      } else if (alone(beams)) {
        test_waiting();
        run_one(entry.child.index(), __builtin_ctz(beams), size);
      } else {
        size = open(entry.child.index(), beams, size);
        test_waiting();
      }
    }
    test_waiting();
  }
  /// Takes one beam through the subtree of a node, above what is on the stack.
  void run_one(std::uint32_t index, int p) noexcept {
    octant_ = leading_octant(group_.rays[p]);
    run_one(index, p, 0);
  }

private:
  static bool alone(std::uint32_t beams) noexcept { return (beams & (beams - 1)) == 0; }

  void run_one(std::uint32_t index, int p, const std::int32_t bottom) noexcept {
    std::int32_t size = bottom;
    while (true) {
      const WideNode& node = bvh_.nodes[index];
      const std::uint32_t met = children_of_one(node, p);
      const int row = group_.beam[p].axis >= 0 ? group_.beam[p].first_row() : -1;
      size = push(
          index, met, size, [&](int place) noexcept { return row >= 0 ? group_.beam[p].sign * node.plane[row][place] : -kInfinity; },
          [&](int) noexcept { return 1u << p; });
      while (true) {
        if (size == bottom) return;
        const BeamEntry& entry = stack_[--size];
        if (entry.first > group_.farthest[p]) continue;
        if (entry.child.tag() == WideRef::Tag::inner) {
          index = entry.child.index();
          break;
        }
        test_leaf(entry, p);
      }
    }
  }
  /// Puts the children that are met on the stack, the nearest last. Returns the stack's new size.
  template <class First, class Beams>
  [[gnu::always_inline]] std::int32_t push(std::uint32_t index, std::uint32_t met, std::int32_t size, First first, Beams beams) noexcept {
    const WideNode& node = bvh_.nodes[index];
    const auto put = [&](int place) noexcept {
      stack_[size] = {index * kWideChildren + static_cast<std::uint32_t>(place), node.child[place], first(place), beams(place)};
    };
    if (alone(met)) {
      if (met != 0) put(__builtin_ctz(met));
      return size + (met != 0 ? 1 : 0);
    }
    const std::uint32_t order = node.order[octant_];
    for (int i = kWideChildren - 1; i >= 0; --i) {
      const int place = static_cast<int>(order >> 4 * i & 7);
      put(place);
      size += static_cast<std::int32_t>(met >> place & 1);
    }
    return size;
  }
  /// Asks for what a child refers to: by the time its beams get there it may have come.
  void prefetch(WideRef child) const noexcept {
    if (child.tag() == WideRef::Tag::run) return;
    const char* const at = child.tag() == WideRef::Tag::inner ? reinterpret_cast<const char*>(bvh_.nodes + child.index())
                                                              : reinterpret_cast<const char*>(bvh_.blocks + child.index());
    for (int line = 0; line < 4; ++line) __builtin_prefetch(at + 64 * line);
  }
  /// Puts the children that any of the beams meets on the stack.
  std::int32_t open(std::uint32_t index, std::uint32_t alive, std::int32_t size) noexcept {
    const WideNode& node = bvh_.nodes[index];
    if constexpr (Stats::kCounting) {
      for (std::uint32_t left = alive; left != 0; left &= left - 1) count_visit(group_.rays[__builtin_ctz(left)]);
    }
    count_beam_tests(kWideChildren);
    std::uint32_t met = children_met<L>(group_.whole, node, group_.farthest_of_all());
    std::uint32_t beams[kWideChildren] = {};
    for (std::uint32_t left = met; left != 0; left &= left - 1) {
      const int place = __builtin_ctz(left);
      count_beam_tests(kMaxBeams);
      beams[place] = beams_met(group_, node, place, alive);
      if (beams[place] == 0)
        met &= ~(1u << place);
      else
        prefetch(node.child[place]);
    }
    const float* const first = node.plane[group_.whole.first_row()];
    return push(
        index, met, size, [&](int place) noexcept { return group_.whole.sign * first[place]; }, [&](int place) noexcept { return beams[place]; });
  }
  /// The children of a node that a beam meets, as bits.
  std::uint32_t children_of_one(const WideNode& node, int p) noexcept {
    const Packet<L, kGroups>& packet = group_.rays[p];
    const Beam& beam = group_.beam[p];
    count_visit(packet);
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
  void test_leaf(const BeamEntry& entry, int p) noexcept {
    Packet<L, kGroups>& packet = group_.rays[p];
    const Beam& beam = group_.beam[p];
    const bool is_block = entry.child.tag() == WideRef::Tag::block;
    std::uint32_t triangles = 0;
    if (is_block) {
      const TriangleBlock& block = bvh_.blocks[entry.child.index()];
      triangles = beam.axis >= 0 ? triangles_met<L>(beam, block, group_.farthest[p]) : (1u << block.count) - 1;
      if (triangles == 0) return;
    }
    typename L::Mask lanes[Packet<L, kGroups>::kCapacity];
    if (!rays_meet(bvh_.nodes[entry.box / kWideChildren], static_cast<int>(entry.box % kWideChildren), packet, lanes, stats_)) return;
    if constexpr (Stats::kCounting) {
      for (int g = 0; g < packet.group_count(); ++g) {
        if (L::any(lanes[g])) stats_.template count<Event::leaf_visit, L>(lanes[g]);
      }
    }
    if (is_block)
      test_triangles<Q>(bvh_.blocks[entry.child.index()], triangles, packet, lanes, stats_);
    else
      test_run<Q, L, kGroups>(packet, lanes, bvh_.pools, bvh_.runs[entry.child.index()], nullptr, stats_);
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
  BeamEntry* stack_;
  BeamGroup<L, kGroups>& group_;
  bool one_ray_;
  Stats stats_;
  std::uint32_t octant_ = 0;
};

/// Calls traverse.operator()<kGroups>() with as many registers as a beam's rays take.
template <class L, class Traverse>
void with_beam_groups(std::int32_t packet, Traverse&& traverse) noexcept {
  if (packet <= L::kWidth)
    traverse.template operator()<1>();
  else
    traverse.template operator()<kBeamRays / L::kWidth>();
}

template <Query Q, class L, class Stats>
void trace(const WideBvhView& bvh, const TraceArgs& args, Stats stats) noexcept {
  auto* const stack = reinterpret_cast<BeamEntry*>(args.scratch);
  const auto at_most = [](std::int32_t count, std::int32_t most) noexcept { return count < most ? count : most; };
  const std::int32_t group_rays = args.packet < kBeamRays ? args.packet : bvh.group_rays;
  with_beam_groups<L>(args.packet, [&]<int kGroups>() noexcept {
    BeamGroup<L, kGroups> group;
    for (std::int32_t first = 0; first < args.rays.count; first += group_rays) {
      const std::int32_t count = at_most(args.rays.count - first, group_rays);
      group.count = 0;
      for (std::int32_t b = 0; b < count; b += kBeamRays) load_packet(args.rays, first + b, at_most(count - b, kBeamRays), group.rays[group.count++]);
      Walk<Q, L, kGroups, Stats> walk(bvh, stack, group, args.packet == 1, stats);
      if (group.make_beams(bvh.box, kSlimGroup<Q>))
        walk.run_group(group.alive);
      else
        for (std::uint32_t left = group.alive; left != 0; left &= left - 1) walk.run_one(0, __builtin_ctz(left));
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
