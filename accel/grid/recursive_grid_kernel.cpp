// Traversal of grids in cells of grids (Jevans, Wyvill 1989). Rays walk as through a uniform grid (grid_walk_kernel.h); those of a packet that stand in the
// same cell go through the grid that it holds together, and wait for each other at its end. Memory: a link per cell, lists only for cells that hold any
// primitive.
//
// Events: node_visit for every grid that is entered, the outermost one by every ray, and for every elementary cell (N_TS); leaf_visit for elementary cells
// alone (N_ETS), of them empty_leaf_visit where nothing is listed (N_EETS).
//
// Why no hit is lost: the head of grid_walk_kernel.h, at each level; the lists of a grid in a cell hold all that the cell's own list would, shared out by the
// same margin. Mailbox: PacketMailbox, for the cells that list a primitive need not follow each other on a ray.
//
// Steps are bounded: a level adds at most nx + ny + nz - 2 cells to each cell of the level above, and there are kMaxGridLevels levels.

#include "accel/grid/recursive_grid_kernel.h"

#include "accel/grid/grid_lanes_kernel.h"
#include "accel/packet_mailbox_kernel.h"

namespace raymeter {

namespace {

/// Lists of coarse cells are long, and those that list a primitive lie apart.
using NestedMailbox = PacketMailbox<256>;

template <Query Q, class L, int kGroups, class Stats>
class RecursiveWalk {
  using Float = typename L::Float;
  using Mask = typename L::Mask;
  static constexpr int kCapacity = Packet<L, kGroups>::kCapacity;

public:
  RecursiveWalk(const RecursiveGridView& grid, NestedMailbox& mailbox, Packet<L, kGroups>& packet, Stats stats) noexcept
      : grid_(grid), mailbox_(mailbox), packet_(packet), stats_(stats), in_order_(packet.shared_octant() >= 0) {}

  void run() noexcept {
    GridWalk<L> walk[kCapacity];
    Float entered[kCapacity];
    Mask irregular[kCapacity];
    bool all_regular = true;
    for (int g = 0; g < packet_.group_count(); ++g) {
      const RayPacket<L>& ray = packet_.ray[g];
      const Mask live = packet_.live(g), serves = regular(grid_.frame, ray);
      irregular[g] = live & ~serves;
      all_regular = all_regular && L::none(irregular[g]);
      count<Event::node_visit>(live & serves);
      const SlabInterval<L> inside = way_through(ray, packet_.hit[g].t, BoxPlanes<L, false>(grid_.frame.box, 0), grid_.from_origin);
      walk[g].live = live & serves & (inside.t_near <= inside.t_far);
      walk[g].t_end = inside.t_far;
      entered[g] = inside.t_near;
    }
    for (std::int32_t k = 0; k < grid_.kind_count && !all_regular; ++k) {
      test_refs<Q, L, kGroups>(packet_, irregular, grid_.pools, grid_.kind[k], grid_.prim_count[k], PositionRefs{0}, stats_);
    }
    go_through(grid_.grids[0], walk, entered);
  }

private:
  template <Event E>
  void count(Mask lanes) noexcept {
    if constexpr (Stats::kCounting) {
      if (L::any(lanes)) stats_.template count<E, L>(lanes);
    }
  }
  /// Takes the live walks through a grid, from the times at which they enter it.
  void go_through(const NestedGrid& cells, GridWalk<L>* walk, Float* entered) noexcept {
    for (int g = 0; g < packet_.group_count(); ++g) enter(cells, packet_.ray[g], entered[g], walk[g]);
    for_each_front(cells, packet_, in_order_, walk, [&](const Mask* front) noexcept {
      visit_cells(cells, walk, front, entered);
      for (int g = 0; g < packet_.group_count(); ++g) entered[g] = L::select(front[g], next_crossing(walk[g]), entered[g]);
    });
  }
  /// Visits the cells in which the lanes of the front stand, each once.
  void visit_cells(const NestedGrid& cells, const GridWalk<L>* walk, const Mask* front, const Float* entered) noexcept {
    alignas(64) std::int32_t cell_of[kCapacity][L::kWidth];
    std::uint32_t left[kCapacity];
    for (int g = 0; g < packet_.group_count(); ++g) {
      left[g] = L::bits(front[g]);
      if (left[g] != 0) L::store(cell_of[g], walk[g].cell);
    }
    Mask here[kCapacity];
    for (int first = 0; first < packet_.group_count(); ++first) {
      while (left[first] != 0) {
        const std::int32_t cell = cell_of[first][__builtin_ctz(left[first])];
        for (int g = first; g < packet_.group_count(); ++g) {
          here[g] = front[g] & L::equal(walk[g].cell, typename L::Int(cell));
          left[g] &= ~L::bits(here[g]);
        }
        visit_cell(grid_.cells[cells.first_cell + cell], walk, here, first, entered);
      }
      here[first] = L::mask(0);
    }
  }
  /// `here` says which lanes of the registers from `first` on stand in the cell.
  void visit_cell(CellLink link, const GridWalk<L>* walk, const Mask* here, int first, const Float* entered) noexcept {
    for (int g = first; g < packet_.group_count(); ++g) {
      count<Event::node_visit>(here[g]);
      if (link.is_grid()) continue;
      count<Event::leaf_visit>(here[g]);
      if (link.is_empty()) count<Event::empty_leaf_visit>(here[g]);
    }
    if (link.is_empty()) return;
    if (link.is_grid()) {
      descend(grid_.grids[link.grid()], walk, here, entered);
      return;
    }
    const std::int32_t* const slot = grid_.first + static_cast<std::int64_t>(link.list()) * grid_.kind_count;
    for (std::int32_t k = 0; k < grid_.kind_count; ++k) {
      const std::int32_t count = slot[k + 1] - slot[k];
      if (count == 0) continue;
      const UnmetRefs<L, NestedMailbox::kSlots> refs{grid_.refs + slot[k], static_cast<std::uint32_t>(k), grid_.mailbox ? &mailbox_ : nullptr};
      test_refs<Q, L, kGroups>(packet_, here, grid_.pools, grid_.kind[k], count, refs, stats_);
    }
  }
  void descend(const NestedGrid& cells, const GridWalk<L>* walk, const Mask* here, const Float* entered) noexcept {
    GridWalk<L> inner[kCapacity];
    Float from[kCapacity];
    for (int g = 0; g < packet_.group_count(); ++g) {
      inner[g].live = here[g] & packet_.live(g);
      inner[g].t_end = L::min(next_crossing(walk[g]), walk[g].t_end);
      from[g] = entered[g];
    }
    go_through(cells, inner, from);
  }

  const RecursiveGridView& grid_;
  NestedMailbox& mailbox_;
  Packet<L, kGroups>& packet_;
  Stats stats_;
  bool in_order_;
};

template <Query Q, class L, class Stats>
void trace(const RecursiveGridView& grid, const TraceArgs& args, Stats stats) noexcept {
  NestedMailbox mailbox;
  with_groups<L>(args.packet, [&]<int kGroups>() noexcept {
    for_each_packet<Q, L, kGroups>(args, [&](Packet<L, kGroups>& packet) noexcept {
      mailbox.clear();
      RecursiveWalk<Q, L, kGroups, Stats>(grid, mailbox, packet, stats).run();
    });
  });
}

}  // namespace

template <Isa I, class Stats>
void RecursiveGridKernel<I, Stats>::closest(const RecursiveGridView& grid, const TraceArgs& args, Counters* counters) noexcept {
  trace<Query::closest, Lanes<I>>(grid, args, Stats(counters));
}

template <Isa I, class Stats>
void RecursiveGridKernel<I, Stats>::any(const RecursiveGridView& grid, const TraceArgs& args, Counters* counters) noexcept {
  trace<Query::any, Lanes<I>>(grid, args, Stats(counters));
}

template struct RecursiveGridKernel<kKernelIsa, NoStats>;
template struct RecursiveGridKernel<kKernelIsa, CountStats>;

}  // namespace raymeter
