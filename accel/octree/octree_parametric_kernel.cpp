#include "accel/octree/octree_parametric_kernel.h"

#include "accel/octree/octree_parametric_traversal_kernel.h"

namespace raymeter {

namespace {

template <Query Q, class L, class Stats>
void trace(const OctreeView& tree, const TraceArgs& args, Stats stats) noexcept {
  auto& scratch = *reinterpret_cast<OctreeScratch*>(args.scratch);
  with_groups<L>(args.packet, [&]<int kGroups>() noexcept {
    for_each_packet<Q, L, kGroups>(args, [&](Packet<L, kGroups>& packet) noexcept {
      if (tree.mailbox) scratch.mailbox.clear();
      typename L::Mask lanes[Packet<L, kGroups>::kCapacity];
      for (int g = 0; g < packet.group_count(); ++g) lanes[g] = packet.live(g);
      if (Q == Query::any && !tree.nearest_blocker)
        traverse_by_parameter<Query::any>(tree, packet, lanes, scratch, stats);
      else
        traverse_by_parameter<Query::closest>(tree, packet, lanes, scratch, stats);
    });
  });
}

}  // namespace

template <Isa I, class Stats>
void OctreeParametricKernel<I, Stats>::closest(const OctreeView& tree, const TraceArgs& args, Counters* counters) noexcept {
  trace<Query::closest, Lanes<I>>(tree, args, Stats(counters));
}

template <Isa I, class Stats>
void OctreeParametricKernel<I, Stats>::any(const OctreeView& tree, const TraceArgs& args, Counters* counters) noexcept {
  trace<Query::any, Lanes<I>>(tree, args, Stats(counters));
}

template struct OctreeParametricKernel<kKernelIsa, NoStats>;
template struct OctreeParametricKernel<kKernelIsa, CountStats>;

}  // namespace raymeter
