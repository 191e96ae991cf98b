#pragma once

// Traversal of an octree by the rays' parameter (Gargantini, Atkinson 1993; Revelles et al. 2000), a packet at a time: all its rays descend together, each lane
// with its own interval [t_near, t_far] in the cell, which the crossings of the three planes that divide it cut into those of its children. Memory: one frame
// for every level, in the slice's scratch. Departures from the papers: children are looked at in the one order that suits all rays of an octant instead of by a
// table of successors for each entry plane, because lanes enter through different faces; a lane takes part in those whose interval is not empty.
//
// Events: node_visit for every cell entered, inner or leaf (N_TS); leaf_visit for the leaves among them (N_ETS), of these empty_leaf_visit where nothing is
// listed (N_EETS). Executed once per register that has a lane in the cell.
//
// Order. Where all rays of a packet share their octant, child k in the order is on the far side of plane a where bit a of k is set; no child comes before one
// that its rays leave for it. Where they do not, the order is that of one of them: lanes are culled by their own intervals, so only time is lost.
//
// Why no hit is lost. Let u be the unit roundoff and P = org + t dir a hit. error_bounds.h puts P on each axis within kPrimitiveError |P - org| = 16u |P - org|
// of the primitive's padded box. Let Q be the point of that box next to P: the leaf that holds Q lists the primitive, and so does every cell around it. A plane
// at or before Q is crossed at (plane - org) / dir <= t (1 + 16u), computed with 3u more; one at or behind Q at t (1 - 16u) or later. So with the computed
// crossings t_near (1 - kSlabPadding) <= t <= t_far (1 + kSlabPadding) in all these cells, kSlabPadding being 20u, and the lane enters them while t is not
// beyond its nearest hit; slab_slack does the same for negative t. Where a direction is 0 the crossing is infinite, with the sign that keeps the lane on its
// side, or NaN in the plane itself: then both sides are entered. So every lane is served, from wherever it starts.
//   Lists of what touches a cell itself (`exact`) need more: P is within kSurfaceError (|P - org| + size) of the surface, in any direction, so lists reach
// beyond their cells by a margin that is enough for rays within reach; others are tested against everything.
//
// Why it ends: a lane's frames are the nodes of a path in the tree, and each frame hands its eight children out once. A packet visits no cell twice; a ray
// visits at most the tree's cells, and of the children of a node, but for ties within the padding, four.

#include "accel/octree/octree_leaf_kernel.h"
#include "core/bounds/way_through_kernel.h"

namespace raymeter {

/// The crossings of the planes that divide a node by the rays of a register.
template <class L>
struct SplitCrossings {
  typename L::Float t[3];

  SplitCrossings(const OctreeNode& node, const RayPacket<L>& ray) noexcept {
    for (int a = 0; a < 3; ++a) t[a] = (typename L::Float(node.split[a]) - ray.org[a]) * ray.inv_dir[a];
  }
};

template <class L>
[[gnu::always_inline]] inline typename L::Float earlier(const RayPacket<L>& ray, typename L::Float t) noexcept {
  return L::mul_add(t, typename L::Float(1.0f - kSlabPadding), -ray.slab_slack);
}
template <class L>
[[gnu::always_inline]] inline typename L::Float later(const RayPacket<L>& ray, typename L::Float t) noexcept {
  return L::mul_add(t, typename L::Float(1.0f + kSlabPadding), ray.slab_slack);
}

/// Children by their bit, reordered: bit k of the result is bit k ^ octant of `children`.
[[nodiscard]] inline std::uint32_t in_order(std::uint32_t children, std::uint32_t octant) noexcept {
  if ((octant & 1) != 0) children = (children & 0x55u) << 1 | (children >> 1 & 0x55u);
  if ((octant & 2) != 0) children = (children & 0x33u) << 2 | (children >> 2 & 0x33u);
  if ((octant & 4) != 0) children = (children & 0x0Fu) << 4 | (children >> 4 & 0x0Fu);
  return children;
}

/// Rays of one slice under way in a tree. kUniform: all live rays of the packet share their octant.
template <Query Q, bool kUniform, class L, int kGroups, class Stats>
class ParametricTraversal {
  using Float = typename L::Float;
  using Mask = typename L::Mask;
  static constexpr int kCapacity = Packet<L, kGroups>::kCapacity;

public:
  ParametricTraversal(const OctreeView& tree, Packet<L, kGroups>& packet, OctreeScratch& scratch, std::uint32_t octant, Stats stats) noexcept
      : tree_(tree), packet_(packet), scratch_(scratch), octant_(octant), stats_(stats) {}

  /// Traces the lanes in `lanes`.
  void run(const Mask* lanes) noexcept {
    if (enter_root(lanes) == 0) return;
    if (tree_.root < 0) {
      visit_leaf<Q>(tree_, ~tree_.root, packet_, live_, scratch_.mailbox, stats_);
      return;
    }
    OctreeFrame* const bottom = scratch_.frames();
    OctreeFrame* frame = bottom;
    open(tree_.root, *frame);
    for (;;) {
      while (frame->pending == 0) {
        if (frame == bottom) return;
        --frame;
      }
      const auto k = static_cast<std::uint32_t>(__builtin_ctz(frame->pending));
      frame->pending &= frame->pending - 1;
      if (enter_child(*frame, k) == 0) continue;
      const std::int32_t link = frame->node->child[k ^ octant_];
      if (link < 0)
        visit_leaf<Q>(tree_, ~link, packet_, live_, scratch_.mailbox, stats_);
      else
        open(link, *++frame);
    }
  }

private:
  /// Sets the lanes' intervals in the root cell; returns whether any is live.
  std::uint32_t enter_root(const Mask* lanes) noexcept {
    std::uint32_t any = 0;
    for (int g = 0; g < packet_.group_count(); ++g) {
      const SlabInterval<L> inside = way_through(packet_.ray[g], packet_.hit[g].t, BoxPlanes<L, false>(tree_.box, 0), tree_.from_origin);
      t_near_[g] = inside.t_near;
      t_far_[g] = inside.t_far;
      live_[g] = lanes[g] & (inside.t_near <= inside.t_far);
      any |= L::bits(live_[g]);
    }
    return any;
  }

  /// Sets the lanes' intervals in a child of a frame's node; returns whether any is live.
  [[gnu::always_inline]] inline std::uint32_t enter_child(const OctreeFrame& frame, std::uint32_t k) noexcept {
    std::uint32_t any = 0;
    for (int g = 0; g < packet_.group_count(); ++g) {
      const RayPacket<L>& ray = packet_.ray[g];
      const int lane = g * L::kWidth;
      Float t_near = L::load(frame.t_near + lane), t_far = L::load(frame.t_far + lane);
      for (int a = 0; a < 3; ++a) {
        const Float t = L::load(frame.t_split[a] + lane);
        const bool far_side = (k >> a & 1) != 0;
        if constexpr (kUniform) {
          if (far_side)
            t_near = L::max(t, t_near);
          else
            t_far = L::min(t, t_far);
        } else {
          const Mask above = ((k ^ octant_) >> a & 1) != 0 ? ~ray.negative[a] : ray.negative[a];  // whose far side it is
          t_near = L::select(above, L::max(t, t_near), t_near);
          t_far = L::select(above, t_far, L::min(t, t_far));
        }
      }
      t_near_[g] = t_near;
      t_far_[g] = t_far;
      live_[g] = earlier(ray, t_near) <= L::min(later(ray, t_far), packet_.hit[g].t);
      any |= L::bits(live_[g]);
    }
    return any;
  }

  /// Makes a frame of the node that the live lanes have entered.
  [[gnu::always_inline]] inline void open(std::int32_t link, OctreeFrame& frame) noexcept {
    const OctreeNode& node = tree_.nodes[link];
    frame.node = &node;
    count_visit<Event::node_visit, L>(live_, packet_.group_count(), stats_);
    std::uint32_t on_side[3][2] = {};  // whether any lane gets to the near (low) and to the far (high) side
    for (int g = 0; g < packet_.group_count(); ++g) {
      const RayPacket<L>& ray = packet_.ray[g];
      const int lane = g * L::kWidth;
      const SplitCrossings<L> crossings(node, ray);
      const Float begin = earlier(ray, t_near_[g]), end = L::min(later(ray, t_far_[g]), packet_.hit[g].t);
      L::store(frame.t_near + lane, L::select(live_[g], t_near_[g], Float(kInfinity)));
      L::store(frame.t_far + lane, t_far_[g]);
      for (int a = 0; a < 3; ++a) {
        L::store(frame.t_split[a] + lane, crossings.t[a]);
        // Negated, so that NaN gets to both sides.
        const Mask near_side = live_[g] & ~(begin > later(ray, crossings.t[a])), far_side = live_[g] & ~(earlier(ray, crossings.t[a]) > end);
        if constexpr (kUniform) {
          on_side[a][0] |= L::bits(near_side);
          on_side[a][1] |= L::bits(far_side);
        } else {
          on_side[a][0] |= L::bits((near_side & ~ray.negative[a]) | (far_side & ray.negative[a]));
          on_side[a][1] |= L::bits((near_side & ray.negative[a]) | (far_side & ~ray.negative[a]));
        }
      }
    }
    frame.pending = children_on(on_side) & ~(Stats::kCounting ? 0u : in_order(node.empty, octant_));
  }

  /// The children on the sides that lanes get to, in the order of the packet.
  [[nodiscard]] std::uint32_t children_on(const std::uint32_t (&on_side)[3][2]) const noexcept {
    constexpr std::uint32_t kBelow[3] = {0x55, 0x33, 0x0F};
    std::uint32_t children = 0xFF;
    for (int a = 0; a < 3; ++a) children &= (on_side[a][0] != 0 ? kBelow[a] : 0u) | (on_side[a][1] != 0 ? ~kBelow[a] : 0u);
    return kUniform ? children : in_order(children, octant_);
  }

  const OctreeView& tree_;
  Packet<L, kGroups>& packet_;
  OctreeScratch& scratch_;
  const std::uint32_t octant_;  ///< child k in the order is child k ^ octant
  const Stats stats_;
  Float t_near_[kCapacity];  ///< in the cell that was entered last
  Float t_far_[kCapacity];
  Mask live_[kCapacity];
};

/// Traces the lanes in `lanes` by the rays' parameter.
template <Query Q, class L, int kGroups, class Stats>
void traverse_by_parameter(const OctreeView& tree, Packet<L, kGroups>& packet, typename L::Mask* lanes, OctreeScratch& scratch, Stats stats) noexcept {
  using Mask = typename L::Mask;
  if (tree.exact) {
    Mask beyond[Packet<L, kGroups>::kCapacity];
    std::uint32_t any = 0;
    for (int g = 0; g < packet.group_count(); ++g) {
      const Mask served = within_reach(tree, packet.ray[g]);
      beyond[g] = lanes[g] & ~served;
      lanes[g] = lanes[g] & served;
      any |= L::bits(beyond[g]);
    }
    if (any != 0) test_everything<Q>(tree, packet, beyond, stats);
  }
  const std::int32_t octant = packet.shared_octant();
  if (octant >= 0) {
    ParametricTraversal<Q, true, L, kGroups, Stats>(tree, packet, scratch, static_cast<std::uint32_t>(octant), stats).run(lanes);
  } else {
    const int first = 0;
    std::uint32_t order = 0;
    for (int a = 0; a < 3; ++a) order |= (L::bits(packet.ray[first].negative[a]) & 1u) << a;
    ParametricTraversal<Q, false, L, kGroups, Stats>(tree, packet, scratch, order, stats).run(lanes);
  }
}

}  // namespace raymeter
