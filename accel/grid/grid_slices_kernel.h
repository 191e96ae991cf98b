#pragma once

// Coherent traversal of a uniform grid (Wald, Ize, Kensler, Knoll, Parker 2006): a packet goes through the grid slice by slice along the axis that its rays
// advance along the most. In each slice it visits the rectangle of cells that its beams of sixteen rays cover; a primitive that these cells list is tested
// against the beams that do not pass beside it. Departures from the paper: beams instead of corner rays (beam_kernel.h), several to a packet, all of them
// tested against a primitive at once; the mailbox needs no memory.
//
// Why no hit is lost. A hit's point P lies inside its ray's beam with the beam's whole padding to spare, and the primitive's padded box within the grid's
// margin of P (grid_walk_kernel.h, 3): the list of the cell that holds P, in exact arithmetic, names the primitive. A beam's rectangle is computed with an
// error of at most 16 u m (m as in beam_kernel.h: two roundings of a coordinate each for the lines, the difference, the reciprocal and the planes), a fifth of
// the padding, so it holds that cell. A packet leaves a slice only when no hit of its rays can lie beyond it.
//
// Mailbox. The cells that list a primitive form a box. A primitive that a neighbour lists too was met there if that neighbour was visited before: in this
// slice, if the rectangle holds it, or in the last one, where that of the last slice holds it or lies beside it. Only where rectangles move by more than a cell
// from slice to slice past a large primitive is it tested again.
//
// Steps are bounded: there are as many slices as the axis has cells, and a packet whose beams cover many cells at once goes by lanes instead, as does a lone
// ray.
//
// Events: node_visit for the cells of each beam's own rectangle, once per register of its rays; leaf_visit and empty_leaf_visit for the same.

#include "accel/grid/grid_beams_kernel.h"
#include "accel/grid/grid_lanes_kernel.h"

namespace raymeter {

/// Cells that the beams may cover at their ends, per ray; more say that the rays do not stay together.
inline constexpr std::int32_t kCellsPerRay = 4;

template <Query Q, class L, int kGroups, class Stats>
class SliceWalk {
public:
  SliceWalk(const GridView& grid, SliceBeams<L, kGroups>& beams, Stats stats) noexcept : grid_(grid), beams_(beams), stats_(stats) {}

  /// Takes the packet through the grid; false where it does not stay together.
  bool run() noexcept {
    if (!serves() || !beams_.make(grid_.frame)) return false;
    if (beams_.alive == 0) return true;
    std::int32_t stride = 1;
    for (int a = 0; a < 3; ++a) {
      stride_[a] = stride;
      stride *= grid_.frame.resolution[a];
    }
    const std::int64_t most = kCellsPerRay * kBeamRays * beams_.count;
    beams_.cover(beams_.begin, beams_.begin);
    if (beams_.rectangle().size() > most) return false;
    beams_.cover(beams_.end, beams_.end);
    if (beams_.rectangle().size() > most) return false;
    const bool forward = beams_.sign > 0;
    const std::int32_t first = slice_of(forward ? beams_.begin : beams_.end), last = slice_of(forward ? beams_.end : beams_.begin);
    for (std::int32_t slice = first;; slice += forward ? 1 : -1) {
      beams_.cover(slice == 0 ? beams_.begin : plane(slice), slice + 1 == grid_.frame.resolution[beams_.axis[2]] ? beams_.end : plane(slice + 1));
      visit_slice(slice);
      if (slice == last) return true;
      const float leaves = beams_.sign * plane(forward ? slice + 1 : slice);
      for (std::uint32_t left = beams_.alive; left != 0; left &= left - 1) {
        const int b = __builtin_ctz(left);
        if (beams_.farthest[b] < leaves) beams_.alive &= ~(1u << b);
      }
      if (beams_.alive == 0) return true;
    }
  }

private:
  static constexpr std::int32_t kBatch = 64;
  static constexpr std::uint32_t kNever = 1u << 31;  ///< no reference has this bit

  /// Whether the lists are complete for all rays.
  [[nodiscard]] bool serves() const noexcept {
    for (int b = 0; b < beams_.count; ++b) {
      for (int g = 0; g < beams_.rays[b].group_count(); ++g) {
        if (L::any(beams_.rays[b].live(g) & ~regular(grid_.frame, beams_.rays[b].ray[g]))) return false;
      }
    }
    return true;
  }
  [[nodiscard]] float plane(std::int32_t index) const noexcept {
    return grid_plane(static_cast<float>(index), grid_.frame.cell_size[beams_.axis[2]], grid_.frame.origin[beams_.axis[2]]);
  }
  [[nodiscard]] std::int32_t slice_of(float coordinate) const noexcept {
    const int a = beams_.axis[2];
    const float index = (coordinate - grid_.frame.origin[a]) * grid_.frame.inv_cell_size[a];
    const float last = static_cast<float>(grid_.frame.resolution[a] - 1);
    return static_cast<std::int32_t>(index > 0 ? (index < last ? index : last) : 0.0f);
  }
  void visit_slice(std::int32_t slice) noexcept {
    const CellRectangle now = beams_.rectangle();
    const std::int32_t step = stride_[beams_.axis[0]];
    for (std::int32_t j = now.edge[2]; j <= now.edge[3]; ++j) {
      std::int32_t cell = slice * stride_[beams_.axis[2]] + j * stride_[beams_.axis[1]] + now.edge[0] * step;
      for (std::int32_t i = now.edge[0]; i <= now.edge[1]; ++i, cell += step) {
        const bool occupied = (grid_.occupied[static_cast<std::uint32_t>(cell) >> 5] >> (static_cast<std::uint32_t>(cell) & 31u) & 1u) != 0;
        if constexpr (Stats::kCounting) count_cell(i, j, occupied);
        if (occupied) visit_cell(cell, visited_here(now, i, j), visited_before(i, j));
      }
    }
    flush();
    before_ = now;
  }
  /// The neighbours of a cell, as the bits of references, that have been visited in this slice: what any of them lists has been met.
  [[nodiscard]] std::uint32_t visited_here(const CellRectangle& now, std::int32_t i, std::int32_t j) const noexcept {
    return (i > now.edge[0] ? GridRef::neighbour_bit(beams_.axis[0], 0) : 0u) | (j > now.edge[2] ? GridRef::neighbour_bit(beams_.axis[1], 0) : 0u);
  }
  /// The neighbours that lead to a cell of the last slice that has been visited: what all of them list has been met.
  [[nodiscard]] std::uint32_t visited_before(std::int32_t i, std::int32_t j) const noexcept {
    std::uint32_t towards = GridRef::neighbour_bit(beams_.axis[2], beams_.sign > 0 ? 0 : 1);
    const std::int32_t at[2] = {i, j};
    for (int a = 0; a < 2; ++a) {
      const std::int32_t low = before_.edge[2 * a], high = before_.edge[2 * a + 1];
      if (low > high || at[a] < low - 1 || at[a] > high + 1) return kNever;
      if (at[a] < low) towards |= GridRef::neighbour_bit(beams_.axis[a], 1);
      if (at[a] > high) towards |= GridRef::neighbour_bit(beams_.axis[a], 0);
    }
    return towards;
  }
  void count_cell(std::int32_t i, std::int32_t j, bool occupied) noexcept {
    for (std::uint32_t left = beams_.alive; left != 0; left &= left - 1) {
      const int b = __builtin_ctz(left);
      if (!beams_.rectangle_of(b).holds(i, j)) continue;
      for (int g = 0; g < beams_.rays[b].group_count(); ++g) {
        const auto live = beams_.rays[b].live(g);
        if (L::none(live)) continue;
        stats_.template count<Event::node_visit, L>(live);
        stats_.template count<Event::leaf_visit, L>(live);
        if (!occupied) stats_.template count<Event::empty_leaf_visit, L>(live);
      }
    }
  }
  /// Puts what the cell lists on the lists of the beams that may meet it.
  void visit_cell(std::int32_t cell, std::uint32_t here, std::uint32_t before) noexcept {
    const std::int32_t* const slot = grid_.first + static_cast<std::int64_t>(cell) * grid_.kind_count;
    for (std::int32_t k = 0; k < grid_.kind_count; ++k) {
      if (slot[k] == slot[k + 1]) continue;
      if (grid_.kind[k] != kind_) flush();
      kind_ = grid_.kind[k];
      for (std::int32_t r = slot[k]; r < slot[k + 1]; ++r) {
        const std::uint32_t ref = grid_.refs[r];
        const std::uint32_t listed = ref >> GridRef::kIndexBits;
        if (grid_.mailbox && ((listed & here) != 0 || (listed & before) == before)) continue;
        const auto index = static_cast<std::int32_t>(ref & GridRef::kIndexMask);
        for (std::uint32_t left = beams_.that_meet(grid_.pools, kind_, index); left != 0; left &= left - 1) {
          const int b = __builtin_ctz(left);
          list_[b][wanted_[b]++] = index;
          if (wanted_[b] == kBatch) test(b);
        }
      }
    }
  }
  void flush() noexcept {
    for (int b = 0; b < beams_.count; ++b) {
      if (wanted_[b] > 0) test(b);
    }
  }
  void test(int b) noexcept {
    Packet<L, kGroups>& rays = beams_.rays[b];
    typename L::Mask lanes[Packet<L, kGroups>::kCapacity];
    for (int g = 0; g < rays.group_count(); ++g) lanes[g] = rays.live(g);
    test_refs<Q, L, kGroups>(rays, lanes, grid_.pools, kind_, wanted_[b], ListedRefs{list_[b]}, stats_);
    wanted_[b] = 0;
    beams_.update_farthest(b);
  }

  const GridView& grid_;
  SliceBeams<L, kGroups>& beams_;
  Stats stats_;
  PrimKind kind_ = PrimKind::triangle;  ///< of the lists
  std::int32_t stride_[3] = {};
  CellRectangle before_;  ///< of the last slice
  std::int32_t wanted_[kBeams] = {};
  std::int32_t list_[kBeams][kBatch];
};

template <Query Q, class L, int kGroups, class Stats>
void trace_slices(const GridView& grid, const TraceArgs& args, Stats stats) noexcept {
  SliceBeams<L, kGroups> beams;
  for (std::int32_t first = 0; first < args.rays.count; first += args.packet) {
    const std::int32_t left = args.rays.count - first;
    const std::int32_t count = left < args.packet ? left : args.packet;
    beams.load(args.rays, first, count);
    if (!SliceWalk<Q, L, kGroups, Stats>(grid, beams, stats).run()) {
      for (int b = 0; b < beams.count; ++b) traverse_by_lanes<Q, L, DdaForm::recompute, kGroups>(grid, beams.rays[b], stats);
    }
    beams.template store<Q>(args, first, count);
  }
}

}  // namespace raymeter
