#pragma once

// The beams of a packet in a grid, and the cells that they cover.

#include "accel/grid/grid_layout.h"
#include "accel/packet_beams_kernel.h"

namespace raymeter {

/// Cells of a slice, from the least to the greatest index on the one axis across, then on the other.
struct CellRectangle {
  std::int32_t edge[4] = {0, -1, 0, -1};
  [[nodiscard]] bool holds(std::int32_t i, std::int32_t j) const noexcept { return i >= edge[0] && i <= edge[1] && j >= edge[2] && j <= edge[3]; }
  [[nodiscard]] std::int64_t size() const noexcept { return std::int64_t{edge[1] - edge[0] + 1} * (edge[3] - edge[2] + 1); }
};

/// A packet's beams and their rectangles of cells.
template <class L, int kGroups>
struct SliceBeams : PacketBeams<L, kGroups> {
  using Base = PacketBeams<L, kGroups>;
  using Base::kLines, Base::kStep, Base::count, Base::alive;
  alignas(64) float origin[kLines];
  alignas(64) float inv_cell_size[kLines];
  alignas(64) float last[kLines];
  alignas(64) std::int32_t cell[kLines];

  /// Returns whether the rays have an axis and a sign in common, and beams that are finite.
  bool make(const GridFrame& frame) noexcept {
    this->find_alive();
    if (alive == 0) return true;
    Beam whole;
    pick_axis(this->rays, count, whole);
    if (whole.axis < 0 || !Base::make(frame.box, whole)) return false;
    for (int at = 0; at < kLines; ++at) {
      const int a = this->axis[at % 4 / 2];
      origin[at] = frame.origin[a];
      inv_cell_size[at] = frame.inv_cell_size[a];
      last[at] = static_cast<float>(frame.resolution[a] - 1);
    }
    return true;
  }
  /// Sets the rectangles between two planes of the axis.
  void cover(float from, float to) noexcept {
    using Float = typename L::Float;
    for (int line = 0; line < 4 * count; line += kStep) {
      const Float zero = L::load(this->at_zero + line), per = L::load(this->slope + line);
      const Float bound = L::max(L::mul_add(per, Float(from), zero), L::mul_add(per, Float(to), zero)) * L::load(this->side + line);
      const Float index = (bound - L::load(origin + line)) * L::load(inv_cell_size + line);
      L::store(cell + line, L::truncate(L::min(L::max(index, Float(0.0f)), L::load(last + line))));
    }
  }
  [[nodiscard]] CellRectangle rectangle_of(int b) const noexcept {
    const std::int32_t* const edge = cell + 4 * b;
    return {{edge[0], edge[1], edge[2], edge[3]}};
  }
  /// The least rectangle around those of all living beams.
  [[nodiscard]] CellRectangle rectangle() const noexcept {
    CellRectangle all = rectangle_of(__builtin_ctz(alive));
    for (std::uint32_t left = alive & (alive - 1); left != 0; left &= left - 1) {
      const CellRectangle one = rectangle_of(__builtin_ctz(left));
      for (int e = 0; e < 4; e += 2) {
        all.edge[e] = one.edge[e] < all.edge[e] ? one.edge[e] : all.edge[e];
        all.edge[e + 1] = one.edge[e + 1] > all.edge[e + 1] ? one.edge[e + 1] : all.edge[e + 1];
      }
    }
    return all;
  }
};

}  // namespace raymeter
