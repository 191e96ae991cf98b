#pragma once

// Traversal of a uniform grid in which lanes go from cell to cell, each its own way, and those of a packet that stand in the same cell are tested together.

#include "accel/grid/grid_walk_kernel.h"
#include "core/geometry/run_kernel.h"
#include "core/stats/policy.h"

namespace raymeter {

/// A mailbox that needs no memory. A list holds the primitives whose boxes touch the cell; the cells that a box touches form a box, and a ray's steps on an
/// axis all have one direction, so a ray is in them once, from the first to the last without a gap. A primitive that the cell left by the last step lists too
/// was tested there or earlier; one that it does not list was not. The builder keeps with each reference which neighbours list the same primitive.
template <class L, DdaForm F>
struct GridRefs {
  static constexpr Selection kSelection = Selection::tested;
  const std::uint32_t* list;
  const GridWalk<L, F>* walk;  // [group]
  std::uint32_t mailbox;       ///< neighbour bits to look at: all, or none to test whatever a cell lists

  [[nodiscard]] std::int32_t index(std::int32_t k) const noexcept { return static_cast<std::int32_t>(list[k] & GridRef::kIndexMask); }
  [[nodiscard]] typename L::Mask wanted(typename L::Mask lanes, int group, std::int32_t k) const noexcept {
    const std::uint32_t listed = list[k] >> GridRef::kIndexBits & mailbox;
    if (listed == 0) return lanes;
    return lanes & L::equal(walk[group].came & typename L::Int(static_cast<std::int32_t>(listed)), typename L::Int(0));
  }
};

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
template <Query Q, class L, DdaForm F, int kGroups, class Stats>
inline void visit_cells(const GridView& grid, Packet<L, kGroups>& packet, const GridWalk<L, F>* walk, const typename L::Mask* front, Stats stats) noexcept {
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
        const GridRefs<L, F> refs{grid.refs + slot[k], walk, grid.mailbox ? 0x3Fu : 0u};
        test_refs<Q, L, kGroups>(packet, here, grid.pools, grid.kind[k], count, refs, stats);
      }
    }
    here[first] = L::mask(0);
  }
}

/// Tests rays that the grid does not serve against everything.
template <Query Q, class L, int kGroups, class Stats>
inline void test_everything(const GridView& grid, Packet<L, kGroups>& packet, const typename L::Mask* lanes, Stats stats) noexcept {
  for (std::int32_t k = 0; k < grid.kind_count; ++k)
    test_refs<Q, L, kGroups>(packet, lanes, grid.pools, grid.kind[k], grid.prim_count[k], PositionRefs{0}, stats);
}

/// Puts the rays into their first cells; `irregular`: those that the grid does not serve. Whether it serves all.
template <class L, DdaForm F, int kGroups>
[[gnu::always_inline]] inline bool begin_walk(const GridView& grid, const Packet<L, kGroups>& packet, GridWalk<L, F>* walk,
                                              typename L::Mask* irregular) noexcept {
  using Mask = typename L::Mask;
  bool all_regular = true;
  for (int g = 0; g < packet.group_count(); ++g) {
    const RayPacket<L>& ray = packet.ray[g];
    const Mask live = packet.live(g), serves = regular(grid.frame, ray);
    irregular[g] = live & ~serves;
    all_regular = all_regular && L::none(irregular[g]);
    const SlabInterval<L> inside = way_through(ray, packet.hit[g].t, BoxPlanes<L, false>(grid.frame.box, 0), grid.from_origin);
    walk[g].live = live & serves & (inside.t_near <= inside.t_far);
    walk[g].t_end = inside.t_far;
    enter(grid.frame, ray, inside.t_near, walk[g]);
  }
  return all_regular;
}

template <Query Q, class L, DdaForm F, int kGroups, class Stats>
void traverse_by_lanes(const GridView& grid, Packet<L, kGroups>& packet, Stats stats) noexcept {
  GridWalk<L, F> walk[Packet<L, kGroups>::kCapacity];
  typename L::Mask irregular[Packet<L, kGroups>::kCapacity];
  if (!begin_walk(grid, packet, walk, irregular)) test_everything<Q>(grid, packet, irregular, stats);
  for_each_front(grid.frame, packet, packet.shared_octant() >= 0, walk, [&](const typename L::Mask* front) noexcept {
    if constexpr (Stats::kCounting) {
      for (int g = 0; g < packet.group_count(); ++g) {
        if (L::any(front[g])) stats.template count<Event::node_visit, L>(front[g]);
      }
    }
    visit_cells<Q, L, F, kGroups>(grid, packet, walk, front, stats);
  });
}

template <Query Q, class L, DdaForm F, class Stats>
void trace_by_lanes(const GridView& grid, const TraceArgs& args, Stats stats) noexcept {
  with_groups<L>(args.packet, [&]<int kGroups>() noexcept {
    for_each_packet<Q, L, kGroups>(args, [&](Packet<L, kGroups>& packet) noexcept {
      if (Q == Query::any && !grid.nearest_blocker)
        traverse_by_lanes<Query::any, L, F, kGroups>(grid, packet, stats);
      else
        traverse_by_lanes<Query::closest, L, F, kGroups>(grid, packet, stats);
    });
  });
}

}  // namespace raymeter
