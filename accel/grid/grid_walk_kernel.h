#pragma once

// A 3D-DDA (Amanatides, Woo 1987), a register of rays at a time. Departures from the paper: the crossing of a plane is computed from the plane's index,
// (plane - org) * inv_dir, not accumulated, so that it does not drift (dda_form_kernel.h has other forms, the paper's among them); and every lane steps on its
// own by vector arithmetic.
//
// Why no hit is lost by the forms `recompute` and `divide`. Let u be the unit roundoff and P = org + t dir a hit on a primitive at distance |P - org| along
// axis a. error_bounds.h puts P within 16u (|P - org| + extent) of the primitive's box; the padded box covers the extent's part. Let T(i) be the computed
// crossing of plane i: a subtraction, a reciprocal and a product, so 3u relative. T does not decrease along the ray, since each of the operations is monotonic.
//   1. enter() finds a cell with T(its entry plane) <= t_start <= T(its exit plane) on every axis; a border cell has no outer planes, and a lane whose
//   direction
//      is 0 none to cross: 0 * inf is NaN and (plane - org) * inf has the sign that keeps a lane in the cell that it is in.
//   2. A step goes over the plane of the smallest T, which lies not before any entry; so a ray that stands in a cell from time T1 to T2 has
//      T(entry plane) <= T1 <= T2 <= T(exit plane) on every axis, and these spans cover [t_start, t_end] without a gap, ends included.
//   3. So when the ray stands at the hit's t, P lies on every axis within 3u |P - org| of the cell, and the primitive's padded box within 19u |P - org|, with
//      1u to spare for products of these errors. The lists reach `margin` beyond their cell, and |P - org| <= margin / 20u wherever |org - center| <= reach.
//   4. A ray leaves only when the next crossing is beyond its nearest hit (equality goes on) or beyond t_end: that of the box of all hits, or of the cell
//      that holds this grid. A grid inside a cell is entered when the ray enters the cell, so that its spans cover that cell's.
// Rays that 3 does not serve, whose origin is out of reach or a component of whose direction or its reciprocal is denormal, are tested against everything.
//
// Steps are bounded: on an axis of n cells a lane steps at most n - 1 times, since the crossing beyond the border cell is infinite and t_hit is not. So a ray
// visits at most nx + ny + nz - 2 cells, whatever its numbers; NaN ends it, for it compares false.

#include "accel/grid/dda_form_kernel.h"
#include "accel/grid/grid_layout.h"
#include "core/bounds/way_through_kernel.h"
#include "core/ray/packet_loop.h"

namespace raymeter {

/// Where the rays of a register are.
template <class L, DdaForm F = DdaForm::recompute>
struct GridWalk {
  using Float = typename L::Float;
  using Int = typename L::Int;

  typename L::Mask live;
  Int cell;
  Int progress;
  Int came;          ///< neighbour bit of the cell before; 0 in the first
  Float t_end;       ///< where the grid ends, or all that can be hit
  Float exit[3];     ///< the plane through which the ray leaves its cell
  Float t_exit[3];   ///< and when
  Float forward[3];  ///< +1 or -1
  Float no_exit[3];  ///< the plane behind which there is nothing
  Int stride[3];     ///< from a cell to the next, signed
  [[no_unique_address]] DdaAxis<L, F> axis[3];
};

/// Rays whose lists are complete (3).
template <class L>
inline typename L::Mask regular(const GridFrame& frame, const RayPacket<L>& ray) noexcept {
  using Float = typename L::Float;
  typename L::Mask good = ray.t_min == ray.t_min;
  for (int a = 0; a < 3; ++a) {
    const Float speed = L::abs(ray.dir[a]);
    good = good & (L::abs(ray.org[a] - Float(frame.center[a])) <= Float(frame.reach[a])) &
           ((speed == Float(0.0f)) | ((speed >= Float(0x1p-126f)) & (speed <= Float(frame.max_speed[a]))));
  }
  return good;
}

/// Puts the rays into the cells in which they stand at t_start.
template <class L, DdaForm F>
inline void enter(const GridCells& cells, const RayPacket<L>& ray, typename L::Float t_start, GridWalk<L, F>& walk) noexcept {
  using Float = typename L::Float;
  using Int = typename L::Int;
  using Mask = typename L::Mask;
  const Float zero(0.0f), one(1.0f);
  std::int32_t stride = 1;
  walk.cell = Int(0);
  walk.progress = Int(0);
  walk.came = Int(0);
  for (int a = 0; a < 3; ++a) {
    const std::int32_t n = cells.resolution[a];
    const Float last(static_cast<float>(n - 1));
    const Mask negative = ray.negative[a];
    const Float forward = L::select(negative, -one, one);
    const Float point = L::select(ray.dir[a] == zero, ray.org[a], L::mul_add(t_start, ray.dir[a], ray.org[a]));
    // An estimate, inside the grid even from NaN, moved to where the crossings put the ray.
    const Float estimate = L::min(L::max((point - Float(cells.origin[a])) * Float(cells.inv_cell_size[a]), zero), last);
    Float cell = L::to_float(L::truncate(estimate));
    const Float first_cell = L::select(negative, last, zero);
    const Float last_cell = last - first_cell;
    const Float to_entry = L::select(negative, one, zero);
    const Float to_exit = one - to_entry;
    walk.axis[a] = dda_axis<L, F>(cells, ray, a);
    const auto crossed = [&](Float index) noexcept { return crossing<L, F>(cells, ray, walk.axis[a], a, index); };
    for (;;) {
      const Mask late = walk.live & (cell != first_cell) & (crossed(cell + to_entry) > t_start);
      if (L::none(late)) break;
      cell = cell - L::select(late, forward, zero);
    }
    for (;;) {
      const Mask early = walk.live & (cell != last_cell) & (crossed(cell + to_exit) < t_start);
      if (L::none(early)) break;
      cell = cell + L::select(early, forward, zero);
    }
    walk.forward[a] = forward;
    walk.exit[a] = cell + to_exit;
    walk.no_exit[a] = L::select(ray.dir[a] == zero, walk.exit[a], last_cell + to_exit);
    walk.t_exit[a] = L::select(walk.exit[a] == walk.no_exit[a], Float(kInfinity), crossed(walk.exit[a]));
    const Int index = L::truncate(cell);
    walk.cell = walk.cell + index * Int(stride);
    walk.progress = walk.progress + L::select(negative, Int(n - 1) - index, index);
    walk.stride[a] = L::select(negative, Int(-stride), Int(stride));
    stride *= n;
  }
}

/// The time of the next crossing.
template <class L, DdaForm F>
[[gnu::always_inline]] inline typename L::Float next_crossing(const GridWalk<L, F>& walk) noexcept {
  return L::min(L::min(walk.t_exit[0], walk.t_exit[1]), walk.t_exit[2]);
}

/// Takes the lanes in `steps` to their next cells; those for which there is none worth it are live no more.
template <class L, DdaForm F>
[[gnu::always_inline]] inline void step(const GridCells& cells, const RayPacket<L>& ray, typename L::Float t_hit, typename L::Mask steps,
                                        GridWalk<L, F>& walk) noexcept {
  using Float = typename L::Float;
  using Int = typename L::Int;
  using Mask = typename L::Mask;
  const Float t = next_crossing(walk);
  const Mask goes = steps & (t <= L::min(t_hit, walk.t_end));
  walk.live = walk.live & (goes | ~steps);
  walk.progress = walk.progress + L::select(goes, Int(1), Int(0));
  Mask open = goes;  // lanes that have not stepped yet: where planes meet, one at a time
  for (int a = 0; a < 3; ++a) {
    const Mask here = open & (walk.t_exit[a] == t);
    open = open & ~here;
    walk.exit[a] = walk.exit[a] + L::select(here, walk.forward[a], Float(0.0f));
    walk.cell = walk.cell + L::select(here, walk.stride[a], Int(0));
    const Int came =
        L::select(ray.negative[a], Int(static_cast<std::int32_t>(GridRef::neighbour_bit(a, 1))), Int(static_cast<std::int32_t>(GridRef::neighbour_bit(a, 0))));
    walk.came = L::select(here, came, walk.came);
    const Float next = crossing_after_step<L, F>(cells, ray, walk.axis[a], a, walk.exit[a], walk.t_exit[a], here);
    walk.t_exit[a] = L::select(walk.exit[a] == walk.no_exit[a], Float(kInfinity), next);
  }
}

/// The progress of the lane that is furthest behind, -1 where none is live.
template <class L, DdaForm F>
inline std::int32_t least_progress(const GridWalk<L, F>* walk, int groups) noexcept {
  std::int32_t least = -1;
  alignas(64) std::int32_t progress[L::kWidth];
  for (int g = 0; g < groups; ++g) {
    L::store(progress, walk[g].progress);
    for (std::uint32_t left = L::bits(walk[g].live); left != 0; left &= left - 1) {
      const std::int32_t lane = progress[__builtin_ctz(left)];
      if (least < 0 || lane < least) least = lane;
    }
  }
  return least;
}

/// Moves the packet's walks on, cell by cell: calls visit(front) with the lanes that take a step together, then steps them. Where the rays share their octant,
/// lanes step in the order of progress and those further ahead wait: rays that pass through a cell then stand in it at the same time.
template <class L, DdaForm F, int kGroups, class Visit>
inline void for_each_front(const GridCells& cells, const Packet<L, kGroups>& packet, bool in_order, GridWalk<L, F>* walk, Visit visit) noexcept {
  typename L::Mask front[Packet<L, kGroups>::kCapacity];
  for (std::int32_t now = least_progress(walk, packet.group_count()); now >= 0;) {
    bool reached = false;
    for (int g = 0; g < packet.group_count(); ++g) {
      front[g] = walk[g].live;
      if (in_order) front[g] = front[g] & L::equal(walk[g].progress, typename L::Int(now));
      reached = reached || L::any(front[g]);
    }
    if (!reached) {
      now = least_progress(walk, packet.group_count());
      continue;
    }
    visit(front);
    for (int g = 0; g < packet.group_count(); ++g) step(cells, packet.ray[g], packet.hit[g].t, front[g], walk[g]);
    ++now;
  }
}

}  // namespace raymeter
