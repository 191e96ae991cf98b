// Traversal of an octree from leaf to leaf. Point location (Glassner 1984): the next leaf is looked for from the root. Neighbour finding (Samet 1989): the ray
// climbs from the leaf to the smallest cell that holds the point where it leaves, and descends from there. A register of rays at a time, each lane in its own
// cell; lanes that stand in the same leaf are tested together. Memory: of neighbour finding, six planes for each inner cell.
//
// Departure from the papers: the point is never computed. A ray stands at a time t, and it is beyond a plane once t has reached the plane's crossing,
// (plane - org) * inv_dir <= t; a leaf is left at the least of the crossings of its sides that are still to come, and that is the next t. Nothing is moved by
// an epsilon, where planes meet all are crossed at once, and both ways of looking find the same leaf, because they ask the same planes the same question.
//
// Events: node_visit for every cell touched on the way, inner or leaf: down from the root, or up to the smallest common cell and down again (N_TS). leaf_visit
// for the leaves among them (N_ETS), of these empty_leaf_visit where nothing is listed (N_EETS).
//
// Why no hit is lost. Let u be the unit roundoff and P = org + t dir a hit. The ray stands in a leaf from t1 to t2 with crossing(entry side) <= t1 and
// t2 = crossing(nearest exit side), computed, and these spans cover [t_start, t_end] without a gap, ends included; so P is within 3u |P - org| of the leaf in
// which the ray stands at t on each axis, and within kPrimitiveError |P - org| more of the primitive's padded box (error_bounds.h). Lists reach beyond their
// cells by a margin that is larger for every ray whose origin is within reach. A ray goes on while the next t is not beyond its hit or the box of all hits.
// Rays out of reach, and those with a component of the direction whose reciprocal leaves the range, are traced by their parameter, which serves every ray.
//
// Why it ends: t grows with every step, and a plane once crossed stays so; a leaf is told by the planes that are crossed, so none is visited twice. A ray
// visits at most the tree's leaves, and where all cells of a level are alike, as with split = center, at most 3 (2^depth - 1) + 1 of them; each costs at most
// 2 depth + 1 touches. A ray without a crossing to come has t infinite, and NaN compares false: both end.

#include "accel/octree/octree_walk_kernel.h"

#include "accel/octree/octree_parametric_traversal_kernel.h"

namespace raymeter {

namespace {

/// Where the rays of a register are.
template <class L>
struct Walk {
  using Float = typename L::Float;
  using Int = typename L::Int;

  typename L::Mask live;
  Int link;         ///< a node, or ~leaf
  Int parent;       ///< of the leaf
  Float t;          ///< the ray's place
  Float t_end;      ///< the end of all that can be hit
  Float t_exit[3];  ///< when the ray leaves its cell on each axis, infinite where it does not
};

template <class L>
inline typename L::Mask has_good_reciprocals(const RayPacket<L>& ray) noexcept {
  using Float = typename L::Float;
  typename L::Mask good = ray.t_min == ray.t_min;
  for (int a = 0; a < 3; ++a) {
    const Float speed = L::abs(ray.dir[a]);
    good = good & ((speed == Float(0.0f)) | (speed >= Float(0x1p-126f)));
  }
  return good;
}

/// Gathers word `word` of each lane's node.
template <class L>
inline typename L::Float node_float(const OctreeView& tree, typename L::Int node, std::int32_t word) noexcept {
  return L::gather(reinterpret_cast<const float*>(tree.nodes) + word, node * typename L::Int(OctreeWords::kNode));
}
template <class L>
inline typename L::Int node_int(const OctreeView& tree, typename L::Int node, typename L::Int word) noexcept {
  return L::gather(reinterpret_cast<const std::int32_t*>(tree.nodes), node * typename L::Int(OctreeWords::kNode) + word);
}

template <class L>
inline typename L::Mask is_node(typename L::Int link) noexcept {
  return ~L::less(link, typename L::Int(0));
}

/// Takes every live lane down from the node it is at to the leaf that holds its place.
template <class L, class Stats>
inline void descend(const OctreeView& tree, const RayPacket<L>& ray, Walk<L>& walk, Stats stats) noexcept {
  using Float = typename L::Float;
  using Int = typename L::Int;
  using Mask = typename L::Mask;
  for (Mask inner = walk.live & is_node<L>(walk.link); L::any(inner); inner = inner & is_node<L>(walk.link)) {
    stats.template count<Event::node_visit, L>(inner);
    const Int node = L::select(inner, walk.link, Int(0));
    walk.parent = L::select(inner, node, walk.parent);
    Int child(OctreeWords::kChild);
    for (int a = 0; a < 3; ++a) {
      const Float t = (node_float<L>(tree, node, a) - ray.org[a]) * ray.inv_dir[a];
      const Mask crossed = t <= walk.t;
      child = child + L::select((crossed & ~ray.negative[a]) | (ray.negative[a] & ~crossed), Int(1 << a), Int(0));
      walk.t_exit[a] = L::select(inner & (t > walk.t), L::min(t, walk.t_exit[a]), walk.t_exit[a]);  // the plane of an axis that is not divided is infinite
    }
    walk.link = L::select(inner, node_int<L>(tree, node, child), walk.link);
  }
}

/// Takes every live lane up from its leaf to the smallest cell that holds its place.
template <class L, class Stats>
inline void climb(const OctreeView& tree, const RayPacket<L>& ray, Walk<L>& walk, Stats stats) noexcept {
  using Float = typename L::Float;
  using Int = typename L::Int;
  using Mask = typename L::Mask;
  walk.link = L::select(walk.live, walk.parent, walk.link);
  for (Mask climbing = walk.live; L::any(climbing);) {
    const Int node = L::select(climbing, walk.link, Int(0));
    Mask outside = climbing & ~climbing;
    for (int a = 0; a < 3; ++a) {
      const Int side = L::select(ray.negative[a], Int(a), Int(a + 3));
      const Float t = (L::gather(tree.outline, node * Int(OctreeWords::kOutline) + side) - ray.org[a]) * ray.inv_dir[a];
      outside = outside | (t <= walk.t);
      walk.t_exit[a] = L::select(climbing, L::select(t > walk.t, t, Float(kInfinity)), walk.t_exit[a]);
    }
    climbing = climbing & outside;
    if (L::none(climbing)) return;
    stats.template count<Event::node_visit, L>(climbing);
    walk.link = L::select(climbing, node_int<L>(tree, node, Int(OctreeWords::kParent)), walk.link);
  }
}

/// Tests the lanes against the lists of the leaves in which they stand, each leaf once.
template <Query Q, class L, class Stats>
inline void visit_leaves(const OctreeView& tree, Packet<L, 1>& packet, const Walk<L>& walk, OctreeMailbox& mailbox, Stats stats) noexcept {
  using Int = typename L::Int;
  alignas(64) std::int32_t link_of[L::kWidth];
  L::store(link_of, walk.link);
  for (std::uint32_t left = L::bits(walk.live); left != 0;) {
    const std::int32_t link = link_of[__builtin_ctz(left)];
    const typename L::Mask here = walk.live & L::equal(walk.link, Int(link));
    left &= ~L::bits(here);
    visit_leaf<Q>(tree, ~link, packet, &here, mailbox, stats);
  }
}

template <Query Q, bool kNeighbour, class L, class Stats>
void traverse(const OctreeView& tree, Packet<L, 1>& packet, OctreeScratch& scratch, Stats stats) noexcept {
  using Float = typename L::Float;
  using Int = typename L::Int;
  using Mask = typename L::Mask;
  const RayPacket<L>& ray = packet.ray[0];
  const Mask steady = has_good_reciprocals(ray) & within_reach(tree, ray);
  Mask others = packet.live(0) & ~steady;
  if (L::any(others)) traverse_by_parameter<Q>(tree, packet, &others, scratch, stats);

  Walk<L> walk;
  const SlabInterval<L> inside = way_through(ray, packet.hit[0].t, BoxPlanes<L, false>(tree.box, 0), tree.from_origin);
  walk.live = packet.live(0) & steady & (inside.t_near <= inside.t_far);
  walk.t = inside.t_near;
  walk.t_end = inside.t_far;
  walk.link = Int(tree.root);
  walk.parent = Int(0);
  for (Float& t : walk.t_exit) t = Float(kInfinity);
  while (L::any(walk.live)) {
    descend(tree, ray, walk, stats);
    visit_leaves<Q>(tree, packet, walk, scratch.mailbox, stats);
    const Float next = L::min(L::min(walk.t_exit[0], walk.t_exit[1]), walk.t_exit[2]);
    walk.live = walk.live & (next <= L::min(packet.hit[0].t, walk.t_end));
    walk.t = next;
    if constexpr (kNeighbour) {
      climb(tree, ray, walk, stats);
    } else {
      walk.link = Int(tree.root);
      for (Float& t : walk.t_exit) t = Float(kInfinity);
    }
  }
}

template <Query Q, class L, class Stats>
void walk_through(const OctreeView& tree, Packet<L, 1>& packet, OctreeScratch& scratch, Stats stats) noexcept {
  if (tree.neighbour)
    traverse<Q, true>(tree, packet, scratch, stats);
  else
    traverse<Q, false>(tree, packet, scratch, stats);
}

/// Lanes go their own ways, so that a packet is a register at most.
template <Query Q, class L, class Stats>
void trace(const OctreeView& tree, TraceArgs args, Stats stats) noexcept {
  auto& scratch = *reinterpret_cast<OctreeScratch*>(args.scratch);
  if (args.packet > L::kWidth) args.packet = L::kWidth;
  for_each_packet<Q, L, 1>(args, [&](Packet<L, 1>& packet) noexcept {
    if (tree.mailbox) scratch.mailbox.clear();
    if (Q == Query::any && !tree.nearest_blocker)
      walk_through<Query::any>(tree, packet, scratch, stats);
    else
      walk_through<Query::closest>(tree, packet, scratch, stats);
  });
}

}  // namespace

template <Isa I, class Stats>
void OctreeWalkKernel<I, Stats>::closest(const OctreeView& tree, const TraceArgs& args, Counters* counters) noexcept {
  trace<Query::closest, Lanes<I>>(tree, args, Stats(counters));
}

template <Isa I, class Stats>
void OctreeWalkKernel<I, Stats>::any(const OctreeView& tree, const TraceArgs& args, Counters* counters) noexcept {
  trace<Query::any, Lanes<I>>(tree, args, Stats(counters));
}

template struct OctreeWalkKernel<kKernelIsa, NoStats>;
template struct OctreeWalkKernel<kKernelIsa, CountStats>;

}  // namespace raymeter
