// Traversal of a uniform grid by a 3D-DDA (Amanatides, Woo 1987), a register of rays at a time. Memory: one offset per cell and kind of primitive into one
// array of references. Departures from the paper: the crossing of a plane is computed from the plane's index, (plane - org) * inv_dir, never accumulated, so
// that it does not drift; and every lane steps on its own by vector arithmetic.
//
// Order. A ray crosses one plane per step, so a count of the cells between its octant's corner and its own, its progress, grows by one per step. Where the rays
// of a packet share their octant, lanes step in the order of progress and those further ahead wait: rays that pass through a cell then stand in it at the same
// time. Where they do not, all lanes step at once.
//
// Events: node_visit for every step into a cell, the first one included (N_TS; executed once per register that steps). leaf_visit for the same cells (N_ETS),
// of them empty_leaf_visit where the list is empty (N_EETS); a list is executed once for the lanes of a register that stand in its cell, empty cells together.
//
// Mailbox. A list holds the primitives whose boxes touch the cell; the cells that a box touches form a box, and a ray's steps on an axis all have one
// direction, so a ray is in them once, from the first to the last without a gap. A primitive that the cell left by the last step lists too was tested there or
// earlier; one that it does not list was not tested. The builder keeps with each reference which neighbours list the same primitive: no memory of tests is
// needed.
//
// Why no hit is lost. Let u be the unit roundoff and P = org + t dir a hit on a primitive at distance |P - org| along axis a. error_bounds.h puts P within
// 8u (|P - org| + magnitude) of the primitive's box; the padded box covers the magnitude's part. Let T(i) be the computed crossing of plane i: a subtraction, a
// reciprocal and a product, so 3u relative. T does not decrease along the ray, since each of the operations is monotonic.
//   1. enter() finds a cell with T(its entry plane) <= t_start <= T(its exit plane) on every axis; a border cell has no outer planes, and a lane whose
//   direction
//      is 0 none to cross: 0 * inf is NaN and (plane - org) * inf has the sign that keeps a lane in the cell that it is in.
//   2. A step goes over the plane of the smallest T, which lies not before any entry; so a ray that stands in a cell from time T1 to T2 has
//      T(entry plane) <= T1 <= T2 <= T(exit plane) on every axis, and these spans cover [t_start, t_end] without a gap, ends included.
//   3. So when the ray stands at the hit's t, P lies on every axis within 3u |P - org| of the cell, and the primitive's padded box within 12u |P - org|, with
//      1u to spare for products of these errors. The lists reach `margin` beyond their cell, and |P - org| <= margin / 12u wherever |org - center| <= reach.
//   4. A ray leaves only when the next crossing is beyond its nearest hit (equality goes on) or beyond the box of all hits.
// Rays that 3 does not serve, whose origin is out of reach or a component of whose direction or its reciprocal is denormal, are tested against everything.
//
// Steps are bounded: on an axis of n cells a lane steps at most n - 1 times, since the crossing beyond the border cell is infinite and t_hit is not. So a ray
// visits at most nx + ny + nz - 2 cells, whatever its numbers; NaN ends it, for it compares false.

#include "accel/grid/grid_kernel.h"

#include "core/bounds/slab_kernel.h"
#include "core/geometry/run_kernel.h"
#include "core/ray/packet_loop.h"
#include "core/stats/policy.h"

namespace raymeter {

namespace {

/// Where the rays of a register are.
template <class L>
struct Walk {
  using Float = typename L::Float;
  using Int = typename L::Int;

  typename L::Mask live;
  Int cell;
  Int progress;
  Int came;          ///< neighbour bit of the cell before; 0 in the first
  Float t_end;       ///< the end of all that can be hit
  Float exit[3];     ///< the plane through which the ray leaves its cell
  Float t_exit[3];   ///< and when
  Float forward[3];  ///< +1 or -1
  Float no_exit[3];  ///< the plane behind which there is nothing
  Int stride[3];     ///< from a cell to the next, signed
};

/// A mailbox that needs no memory: see the head of this file.
template <class L>
struct GridRefs {
  static constexpr bool kSelective = true;
  const std::uint32_t* list;
  const Walk<L>* walk;  // [group]
  std::uint32_t mailbox;

  [[nodiscard]] std::int32_t index(std::int32_t k) const noexcept { return static_cast<std::int32_t>(list[k] & GridRef::kIndexMask); }
  [[nodiscard]] typename L::Mask wanted(typename L::Mask lanes, int group, std::int32_t k) const noexcept {
    const std::uint32_t listed = list[k] >> GridRef::kIndexBits & mailbox;
    if (listed == 0) return lanes;
    return lanes & L::equal(walk[group].came & typename L::Int(static_cast<std::int32_t>(listed)), typename L::Int(0));
  }
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

/// When the rays cross plane `index`.
template <class L>
inline typename L::Float crossing(const GridFrame& frame, const RayPacket<L>& ray, int a, typename L::Float index) noexcept {
  using Float = typename L::Float;
  return (grid_plane(index, Float(frame.cell_size[a]), Float(frame.origin[a])) - ray.org[a]) * ray.inv_dir[a];
}

/// Puts the rays into the cells in which they stand at t_start.
template <class L>
inline void enter(const GridFrame& frame, const RayPacket<L>& ray, typename L::Float t_start, Walk<L>& walk) noexcept {
  using Float = typename L::Float;
  using Int = typename L::Int;
  using Mask = typename L::Mask;
  const Float zero(0.0f), one(1.0f);
  std::int32_t stride = 1;
  walk.cell = Int(0);
  walk.progress = Int(0);
  walk.came = Int(0);
  for (int a = 0; a < 3; ++a) {
    const std::int32_t n = frame.resolution[a];
    const Float last(static_cast<float>(n - 1));
    const Mask negative = ray.negative[a];
    const Float forward = L::select(negative, -one, one);
    const Float point = L::select(ray.dir[a] == zero, ray.org[a], L::mul_add(t_start, ray.dir[a], ray.org[a]));
    // An estimate, inside the grid even from NaN, moved to where the crossings put the ray.
    const Float estimate = L::min(L::max((point - Float(frame.origin[a])) * Float(frame.inv_cell_size[a]), zero), last);
    Float cell = L::to_float(L::truncate(estimate));
    const Float first_cell = L::select(negative, last, zero);
    const Float last_cell = last - first_cell;
    const Float to_entry = L::select(negative, one, zero);
    const Float to_exit = one - to_entry;
    for (;;) {
      const Mask late = walk.live & (cell != first_cell) & (crossing(frame, ray, a, cell + to_entry) > t_start);
      if (L::none(late)) break;
      cell = cell - L::select(late, forward, zero);
    }
    for (;;) {
      const Mask early = walk.live & (cell != last_cell) & (crossing(frame, ray, a, cell + to_exit) < t_start);
      if (L::none(early)) break;
      cell = cell + L::select(early, forward, zero);
    }
    walk.forward[a] = forward;
    walk.exit[a] = cell + to_exit;
    walk.no_exit[a] = L::select(ray.dir[a] == zero, walk.exit[a], last_cell + to_exit);
    walk.t_exit[a] = L::select(walk.exit[a] == walk.no_exit[a], Float(kInfinity), crossing(frame, ray, a, walk.exit[a]));
    const Int index = L::truncate(cell);
    walk.cell = walk.cell + index * Int(stride);
    walk.progress = walk.progress + L::select(negative, Int(n - 1) - index, index);
    walk.stride[a] = L::select(negative, Int(-stride), Int(stride));
    stride *= n;
  }
}

/// Takes the lanes in `steps` to their next cells; those for which there is none worth it are live no more.
template <class L>
[[gnu::always_inline]] inline void step(const GridFrame& frame, const RayPacket<L>& ray, typename L::Float t_hit, typename L::Mask steps,
                                        Walk<L>& walk) noexcept {
  using Float = typename L::Float;
  using Int = typename L::Int;
  using Mask = typename L::Mask;
  const Float t = L::min(L::min(walk.t_exit[0], walk.t_exit[1]), walk.t_exit[2]);
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
    walk.t_exit[a] = L::select(walk.exit[a] == walk.no_exit[a], Float(kInfinity), crossing(frame, ray, a, walk.exit[a]));
  }
}

/// The lanes whose cells list anything. Every lane has some cell, dead or alive.
template <class L>
inline std::uint32_t occupied_lanes(const GridView& grid, const std::int32_t* cell_of) noexcept {
  std::uint32_t lanes = 0;
  for (int lane = 0; lane < L::kWidth; ++lane) {
    const auto cell = static_cast<std::uint32_t>(cell_of[lane]);
    lanes |= (grid.occupied[cell >> 5] >> (cell & 31u) & 1u) << lane;
  }
  return lanes;
}

/// Tests the rays of a packet against the lists of the cells in which they stand.
template <Query Q, class L, int kGroups, class Stats>
inline void visit_cells(const GridView& grid, Packet<L, kGroups>& packet, const Walk<L>* walk, const typename L::Mask* front, Stats stats) noexcept {
  using Mask = typename L::Mask;
  constexpr int kCapacity = Packet<L, kGroups>::kCapacity;
  alignas(64) std::int32_t cell_of[kCapacity][L::kWidth];
  std::uint32_t left[kCapacity];  // lanes in cells whose lists are still to be tested
  for (int g = 0; g < packet.group_count(); ++g) {
    left[g] = L::bits(front[g]);
    if (left[g] == 0) continue;
    L::store(cell_of[g], walk[g].cell);
    const std::uint32_t occupied = occupied_lanes<L>(grid, cell_of[g]) & left[g];
    if constexpr (Stats::kCounting) {
      const std::uint32_t empty = left[g] & ~occupied;
      if (empty != 0) {
        stats.template count<Event::leaf_visit, L>(L::mask(empty));
        stats.template count<Event::empty_leaf_visit, L>(L::mask(empty));
      }
    }
    left[g] = occupied;
  }
  Mask here[kCapacity];
  for (int first = 0; first < packet.group_count(); ++first) {
    while (left[first] != 0) {
      const std::int32_t cell = cell_of[first][__builtin_ctz(left[first])];
      for (int g = first; g < packet.group_count(); ++g) {
        here[g] = front[g] & L::equal(walk[g].cell, typename L::Int(cell));
        if constexpr (Stats::kCounting) {
          if (L::any(here[g])) stats.template count<Event::leaf_visit, L>(here[g]);
        }
        left[g] &= ~L::bits(here[g]);
      }
      const std::int32_t* const slot = grid.first + static_cast<std::int64_t>(cell) * grid.kind_count;
      for (std::int32_t k = 0; k < grid.kind_count; ++k) {
        const std::int32_t count = slot[k + 1] - slot[k];
        if (count == 0) continue;
        const GridRefs<L> refs{grid.refs + slot[k], walk, grid.mailbox};
        test_refs<Q, L, kGroups>(packet, here, grid.pools, grid.kind[k], count, refs, stats);
      }
    }
    here[first] = L::mask(0);
  }
}

/// The progress of the lane that is furthest behind, -1 where none is live.
template <class L>
inline std::int32_t least_progress(const Walk<L>* walk, int groups) noexcept {
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

template <Query Q, class L, int kGroups, class Stats>
void traverse(const GridView& grid, Packet<L, kGroups>& packet, Stats stats) noexcept {
  using Mask = typename L::Mask;
  Walk<L> walk[Packet<L, kGroups>::kCapacity];
  Mask front[Packet<L, kGroups>::kCapacity];
  bool all_regular = true;
  for (int g = 0; g < packet.group_count(); ++g) {
    const RayPacket<L>& ray = packet.ray[g];
    const Mask live = packet.live(g), serves = regular(grid.frame, ray);
    front[g] = live & ~serves;
    all_regular = all_regular && L::none(front[g]);
    const SlabInterval<L> inside = intersect_box(ray, packet.hit[g].t, BoxPlanes<L, false>(grid.frame.box, 0));
    walk[g].live = live & serves & (inside.t_near <= inside.t_far);
    walk[g].t_end = inside.t_far;
    enter(grid.frame, ray, inside.t_near, walk[g]);
  }
  for (std::int32_t k = 0; k < grid.kind_count && !all_regular; ++k) {
    test_refs<Q, L, kGroups>(packet, front, grid.pools, grid.kind[k], grid.prim_count[k], PositionRefs{0}, stats);
  }

  const bool in_order = packet.shared_octant() >= 0;
  for (std::int32_t now = least_progress(walk, packet.group_count()); now >= 0;) {
    bool reached = false;
    for (int g = 0; g < packet.group_count(); ++g) {
      front[g] = walk[g].live;
      if (in_order) front[g] = front[g] & L::equal(walk[g].progress, typename L::Int(now));
      if (L::none(front[g])) continue;
      reached = true;
      stats.template count<Event::node_visit, L>(front[g]);
    }
    if (!reached) {
      now = least_progress(walk, packet.group_count());
      continue;
    }
    visit_cells<Q, L, kGroups>(grid, packet, walk, front, stats);
    for (int g = 0; g < packet.group_count(); ++g) step(grid.frame, packet.ray[g], packet.hit[g].t, front[g], walk[g]);
    ++now;
  }
}

template <Query Q, class L, class Stats>
void trace(const GridView& grid, const TraceArgs& args, Stats stats) noexcept {
  with_groups<L>(args.packet, [&]<int kGroups>() noexcept {
    for_each_packet<Q, L, kGroups>(args, [&](Packet<L, kGroups>& packet) noexcept { traverse<Q, L, kGroups>(grid, packet, stats); });
  });
}

}  // namespace

template <Isa I, class Stats>
void GridKernel<I, Stats>::closest(const GridView& grid, const TraceArgs& args, Counters* counters) noexcept {
  trace<Query::closest, Lanes<I>>(grid, args, Stats(counters));
}

template <Isa I, class Stats>
void GridKernel<I, Stats>::any(const GridView& grid, const TraceArgs& args, Counters* counters) noexcept {
  trace<Query::any, Lanes<I>>(grid, args, Stats(counters));
}

template struct GridKernel<kKernelIsa, NoStats>;
template struct GridKernel<kKernelIsa, CountStats>;

}  // namespace raymeter
