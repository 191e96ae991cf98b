// Packet traversal of a k-d tree, front to back (Wald, Slusallek, Benthin, Wagner 2001), each ray with the interval [t_near, t_far] in which it is in the node;
// a packet of one ray is the scalar algorithm of the literature (Havran 2000, TA_B rec). Memory: eight bytes a node (kd_layout.h). Departures from the papers:
// rays of a packet may differ in direction signs, in which case each has its own near and far child and most rays' near child is visited first; the intervals
// of the two children overlap by a margin.
//
// Events: node_visit when rays reach an inner node (N_TS), leaf_visit when they reach a leaf (N_ETS), empty_leaf_visit where that leaf holds nothing (N_EETS).
// A ray is live in a node where its interval is not empty, so that it visits there what it would visit alone.
//
// Why no hit is lost. Let u be the unit roundoff and P = org + t dir a hit of a ray whose interval in the box of the scene is [t_begin, t_end]; with
// R = |dir| max(|t_begin|, |t_end|), P and org are no further apart than R. Kernels promise (error_bounds.h) that P lies within 32 u (R + size) of a point Q of
// the primitive or, for kinds that only keep to their boxes, within 16 u (R + extent) of a point Q of its box. Q is in the closed cell of a leaf that lists the
// primitive: builders give every part of a primitive (or box) to the side of a plane that it is on, those in the plane to either. Each ray has a margin
//     m = 48 u (R + size) + 2 u |org|
// on each axis and goes on in the near child up to where it passes the plane's far side at distance m, in the far child from where it passes the near side:
// near_org and far_org are the origin moved by m, so that t_leave = (plane - near_org) / dir, and the like. Let dir > 0 and Q be below the plane (other cases
// are its mirror images). P is at most 32 u (R + size) beyond the plane, so t dir <= plane - org + m - 16 u R; forming near_org errs by u (|org| + m),
// the difference, reciprocal and product by 3u of |plane - org + m|, which is at most 2R + m: t dir >= -R bounds it from below, and where plane - org > 2R
// t_leave is beyond the interval anyway. m has room for both, so that t <= t_leave as computed. For dir = 0 the quotient is infinite with the sign that
// keeps the ray on the sides it may touch, or NaN, which min and max drop: both. A reciprocal of a denormal component overflows likewise, and the ray moves
// less than its margin. Where R overflows everything is visited. A ray leaves early only where its interval begins beyond its nearest hit.
//
// Mailbox: PacketMailbox, for a primitive may be listed in several leaves.
//
// Bounds on a packet (interval arithmetic; Reshetov, Soupikov, Hurley 2005): where all rays share their direction signs, the least and greatest of their
// moved origins, reciprocals and ends bound when any ray passes a plane. Where they show that no ray is in one of the children, the rays' own intervals stay as
// they are, and none is looked at: the visits are the same, one by one.
//
// Steps are bounded: a node is reached from its parent alone and at most once a packet, so that no ray visits more nodes than the tree has, whatever its
// numbers. The stack holds one far child for each level above.

#include "accel/kdtree/kd_kernel.h"

#include "accel/kdtree/kd_travellers_kernel.h"
#include "core/geometry/run_kernel.h"

namespace raymeter {

namespace {

/// How a packet finds its way: rays of mixed direction signs, rays that share them, or these with bounds on the packet as a whole.
enum class Course : std::uint8_t { mixed, uniform, frustum };

/// Goes on to the child that the rays meet first; the other one waits on the stack where any ray meets it too. Returns the node reached.
template <bool kUniform, class L, int kGroups>
[[gnu::always_inline]] inline std::int32_t descend(const KdNode& node, KdTravellers<L, kGroups>& rays, KdStack<L, kGroups>& stack) noexcept {
  using Float = typename L::Float;
  const auto axis = static_cast<std::int32_t>(node.tag());
  const std::int32_t first = rays.order >> axis & 1;
  const Float plane(node.plane());
  std::uint64_t in_first = 0, in_second = 0;
  rays.for_each_group([&](int g) noexcept {
    const RayPacket<L>& ray = rays.packet.ray[g];
    const Float t_near = rays.t_near[g], t_far = rays.t_far[g];
    const Float leave = L::min((plane - rays.near_org[axis][g]) * ray.inv_dir[axis], t_far);
    const Float enter = L::max((plane - rays.far_org[axis][g]) * ray.inv_dir[axis], t_near);
    Float first_near = t_near, first_far = leave, second_near = enter, second_far = t_far;
    if constexpr (!kUniform) {
      const auto agrees = first != 0 ? ray.negative[axis] : ~ray.negative[axis];
      first_near = L::select(agrees, t_near, enter);
      first_far = L::select(agrees, leave, t_far);
      second_near = L::select(agrees, enter, t_near);
      second_far = L::select(agrees, t_far, leave);
    }
    in_first |= std::uint64_t{L::any(first_near <= first_far)} << g;
    in_second |= std::uint64_t{L::any(second_near <= second_far)} << g;
    rays.t_near[g] = first_near;
    rays.t_far[g] = first_far;
    L::store(stack.near_of(stack.size, g), second_near);
    L::store(stack.far_of(stack.size, g), second_far);
  });
  const std::int32_t child = node.first_child();
  if (in_first == 0) {
    rays.groups = in_second;
    rays.for_each_group([&](int g) noexcept {
      rays.t_near[g] = L::load(stack.near_of(stack.size, g));
      rays.t_far[g] = L::load(stack.far_of(stack.size, g));
    });
    return child + (first ^ 1);
  }
  rays.groups = in_first;
  if (in_second != 0) {
    stack.node[stack.size] = child + (first ^ 1);
    stack.groups[stack.size++] = in_second;
  }
  return child + first;
}

/// Takes up the topmost entry in which a ray is still live; -1 where there is none.
template <class L, int kGroups>
inline std::int32_t resume(KdTravellers<L, kGroups>& rays, KdStack<L, kGroups>& stack) noexcept {
  while (stack.size > 0) {
    --stack.size;
    rays.groups = stack.groups[stack.size];
    std::uint64_t in_node = 0;
    rays.for_each_group([&](int g) noexcept {
      rays.t_near[g] = L::load(stack.near_of(stack.size, g));
      rays.t_far[g] = L::min(L::load(stack.far_of(stack.size, g)), rays.packet.hit[g].t);
      in_node |= std::uint64_t{L::any(rays.live(g))} << g;
    });
    rays.groups = in_node;
    if (in_node != 0) return stack.node[stack.size];
  }
  return -1;
}

template <Query Q, class L, int kGroups, class Stats>
inline void visit_leaf(const KdView& tree, const KdNode& leaf, KdTravellers<L, kGroups>& rays, KdMailbox* mailbox, Stats stats) noexcept {
  rays.template count_live<Event::leaf_visit>(stats);
  if (leaf.empty()) {
    rays.template count_live<Event::empty_leaf_visit>(stats);
    return;
  }
  typename L::Mask lanes[KdTravellers<L, kGroups>::kCapacity];
  for (int g = 0; g < rays.packet.group_count(); ++g) lanes[g] = L::mask(0);
  rays.for_each_group([&](int g) noexcept { lanes[g] = rays.live(g); });
  const auto test = [&](PrimKind kind, std::int32_t first, std::int32_t count) noexcept {
    const UnmetRefs<L, KdMailbox::kSlots> refs{tree.refs + first, static_cast<std::uint32_t>(kind), mailbox};
    test_refs<Q, L, kGroups>(rays.packet, lanes, tree.pools, kind, count, refs, stats);
  };
  if (leaf.tag() != KdNode::kRuns) {
    test(static_cast<PrimKind>(leaf.tag() - KdNode::kKind), leaf.first(), leaf.count());
    return;
  }
  for (std::int32_t r = leaf.first(); r < leaf.first() + leaf.count(); ++r) test(tree.runs[r].kind(), tree.runs[r].first, tree.runs[r].count());
}

/// The same with bounds on the packet: where they tell that no ray is in one of the children, no ray's interval changes, and none is looked at.
template <class L, int kGroups>
[[gnu::always_inline]] inline std::int32_t descend(const KdNode& node, KdFrustum& frustum, KdTravellers<L, kGroups>& rays,
                                                   KdStack<L, kGroups>& stack) noexcept {
  const auto axis = static_cast<std::int32_t>(node.tag());
  const std::int32_t first = rays.order >> axis & 1;
  const KdSpan crossing = frustum.crossing(axis, node.plane());
  if (crossing.t_near > frustum.span.t_far) return node.first_child() + first;
  if (crossing.t_far < frustum.span.t_near) return node.first_child() + (first ^ 1);
  const std::int32_t waiting = stack.size;
  const std::int32_t child = descend<true>(node, rays, stack);
  const KdSpan second{crossing.t_near > frustum.span.t_near ? crossing.t_near : frustum.span.t_near, frustum.span.t_far};
  if (stack.size > waiting) stack.span[waiting] = second;
  if (child != node.first_child() + first)
    frustum.span = second;
  else if (crossing.t_far < frustum.span.t_far)
    frustum.span.t_far = crossing.t_far;
  return child;
}

template <Query Q, Course kCourse, class L, int kGroups, class Stats>
void traverse(const KdView& tree, KdTravellers<L, kGroups>& rays, KdStack<L, kGroups>& stack, Stats stats) noexcept {
  KdMailbox mailbox;
  if (tree.mailbox) mailbox.clear();
  KdFrustum frustum;
  if constexpr (kCourse == Course::frustum) rays.bound(frustum);
  for (std::int32_t at = rays.groups != 0 ? 0 : -1; at >= 0;) {
    const KdNode& node = tree.nodes[at];
    if (!node.leaf()) {
      rays.template count_live<Event::node_visit>(stats);
      if constexpr (kCourse == Course::frustum)
        at = descend(node, frustum, rays, stack);
      else
        at = descend<kCourse == Course::uniform>(node, rays, stack);
      continue;
    }
    visit_leaf<Q>(tree, node, rays, tree.mailbox ? &mailbox : nullptr, stats);
    at = resume(rays, stack);
    if constexpr (kCourse == Course::frustum) frustum.span = stack.span[stack.size];
  }
}

template <Query Q, class L, class Stats>
void trace(const KdView& tree, const TraceArgs& args, Stats stats) noexcept {
  with_groups<L>(args.packet, [&]<int kGroups>() noexcept {
    KdStack<L, kGroups> stack(args.scratch, tree.stack_capacity, (args.packet + L::kWidth - 1) / L::kWidth);
    for_each_packet<Q, L, kGroups>(args, [&](Packet<L, kGroups>& packet) noexcept {
      KdTravellers<L, kGroups> rays(tree, packet);
      if (packet.shared_octant() < 0) return traverse<Q, Course::mixed>(tree, rays, stack, stats);
      // One register is looked at as quickly as bounds are.
      if (kGroups != 1 && tree.frustum) return traverse < Q, kGroups != 1 ? Course::frustum : Course::uniform > (tree, rays, stack, stats);
      traverse<Q, Course::uniform>(tree, rays, stack, stats);
    });
  });
}

}  // namespace

template <Isa I, class Stats>
void KdKernel<I, Stats>::closest(const KdView& tree, const TraceArgs& args, Counters* counters) noexcept {
  trace<Query::closest, Lanes<I>>(tree, args, Stats(counters));
}

template <Isa I, class Stats>
void KdKernel<I, Stats>::any(const KdView& tree, const TraceArgs& args, Counters* counters) noexcept {
  trace<Query::any, Lanes<I>>(tree, args, Stats(counters));
}

template struct KdKernel<kKernelIsa, NoStats>;
template struct KdKernel<kKernelIsa, CountStats>;

}  // namespace raymeter
