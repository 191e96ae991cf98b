#pragma once

// The beams of a packet in a grid, side by side in registers.

#include "accel/beam_kernel.h"
#include "accel/grid/grid_layout.h"

namespace raymeter {

inline constexpr int kSliceBeamRays = 16;
inline constexpr int kSliceBeams = kMaxPacket / kSliceBeamRays;
/// Cells of a slice, from the least to the greatest index on the one axis across, then on the other.
struct CellRectangle {
  std::int32_t edge[4] = {0, -1, 0, -1};
  [[nodiscard]] bool holds(std::int32_t i, std::int32_t j) const noexcept { return i >= edge[0] && i <= edge[1] && j >= edge[2] && j <= edge[3]; }
  [[nodiscard]] std::int64_t size() const noexcept { return std::int64_t{edge[1] - edge[0] + 1} * (edge[3] - edge[2] + 1); }
};

/// A packet's beams and their rectangles of cells. Each beam has four lines: below and above its rays on the one axis across, then on the other. They stand in
/// the lanes of registers, pointing outwards: a point (x, c) is outside where side x > slope c + at_zero.
template <class L, int kGroups>
struct SliceBeams {
  static constexpr int kLines = 4 * kSliceBeams;
  static constexpr int kStep = L::kWidth < kLines ? L::kWidth : kLines;
  Packet<L, kGroups> rays[kSliceBeams];
  Beam beam[kSliceBeams];
  float farthest[kSliceBeams];  ///< farthest_plane() of each
  int count = 0;
  std::uint32_t alive = 0;   ///< beams that may still meet something, as bits
  int axis[3] = {};          ///< the two axes across, and the one along the beams
  float begin = 0, end = 0;  ///< coordinates between which hits can lie, the lesser first
  float sign = 1;            ///< of the rays' directions along the axis
  alignas(64) float at_zero[kLines];
  alignas(64) float slope[kLines];
  alignas(64) float side[kLines];       ///< -1 below, 1 above
  alignas(64) float across[2][kLines];  ///< `side` for the lines of this axis, else 0
  alignas(64) float origin[kLines];
  alignas(64) float inv_cell_size[kLines];
  alignas(64) float last[kLines];
  alignas(64) std::int32_t cell[kLines];

  void update_farthest(int b) noexcept { farthest[b] = farthest_plane(beam[b], rays[b]); }

  /// Makes the beams. Returns whether the rays have an axis and a sign in common, and lines that are finite.
  bool make(const GridFrame& frame) noexcept {
    alive = 0;
    for (int b = 0; b < count; ++b) {
      bool lives = false;
      for (int g = 0; g < rays[b].group_count(); ++g) lives |= L::any(rays[b].live(g));
      alive |= (lives ? 1u : 0u) << b;
    }
    if (alive == 0) return true;
    Beam whole;
    pick_axis(rays, count, whole);
    if (whole.axis < 0) return false;
    set_planes(rays, count, frame.box, whole);
    for (int i = 0; i < 2; ++i) axis[i] = whole.across[i];
    axis[2] = whole.axis;
    begin = whole.least(whole.end);
    end = whole.greatest(whole.end);
    sign = whole.sign;
    for (int b = 0; b < kSliceBeams; ++b) {
      beam[b] = whole;
      if ((alive >> b & 1) != 0) {
        if (!set_lines(beam_ends(rays[b], whole), 1.0f, beam[b])) return false;
        update_farthest(b);
      }
      for (int line = 0; line < 4; ++line) draw(frame, b, line);
    }
    return true;
  }
  /// Sets the rectangles between two planes of the axis.
  void cover(float from, float to) noexcept {
    using Float = typename L::Float;
    for (int line = 0; line < 4 * count; line += kStep) {
      const Float zero = L::load(at_zero + line), per = L::load(slope + line);
      const Float bound = L::max(L::mul_add(per, Float(from), zero), L::mul_add(per, Float(to), zero)) * L::load(side + line);
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
  /// The beams, as bits, that do not have the whole triangle outside one of their sides.
  [[nodiscard]] std::uint32_t that_meet(const TriangleView& pool, std::int32_t triangle) const noexcept {
    using Float = typename L::Float;
    const std::int32_t at = triangle * pool.stride;
    return beams_within([&](Float zero, Float per, Float first, Float second) noexcept {
      const auto beyond = [&](int v) noexcept {
        const Float x(pool.vertex[v][axis[0]][at]), y(pool.vertex[v][axis[1]][at]), c(pool.vertex[v][axis[2]][at]);
        return L::mul_add(x, first, y * second) > L::mul_add(per, c, zero);
      };
      return beyond(0) & beyond(1) & beyond(2);
    });
  }
  /// The same for a box.
  [[nodiscard]] std::uint32_t that_meet(const float* box_min, const float* box_max) const noexcept {
    using Float = typename L::Float;
    const Float none(0.0f);
    return beams_within([&](Float zero, Float per, Float first, Float second) noexcept {
      // The corner that is furthest inside.
      const Float x = L::select(first > none, Float(box_min[axis[0]]), Float(box_max[axis[0]]));
      const Float y = L::select(second > none, Float(box_min[axis[1]]), Float(box_max[axis[1]]));
      const Float c = L::select(per > none, Float(box_max[axis[2]]), Float(box_min[axis[2]]));
      return L::mul_add(x, first, y * second) > L::mul_add(per, c, zero);
    });
  }

private:
  /// The beams that have no line of which outside(at_zero, slope, across[0], across[1]) is true.
  template <class Outside>
  [[nodiscard]] [[gnu::always_inline]] std::uint32_t beams_within(Outside outside) const noexcept {
    std::uint32_t lines = 0;
    for (int line = 0; line < 4 * count; line += kStep) {
      const auto beyond = outside(L::load(at_zero + line), L::load(slope + line), L::load(across[0] + line), L::load(across[1] + line));
      lines |= (L::bits(beyond) & ((1u << kStep) - 1u)) << line;
    }
    std::uint32_t met = 0;
    for (int b = 0; b < kSliceBeams; ++b) met |= ((lines >> 4 * b & 0xFu) == 0 ? 1u : 0u) << b;
    return met & alive;
  }
  void draw(const GridFrame& frame, int b, int line) noexcept {
    const bool lives = (alive >> b & 1) != 0;
    const int i = line / 2, a = axis[i], at = 4 * b + line;
    const BeamLine& from = line % 2 == 0 ? beam[b].low[i] : beam[b].high[i];
    side[at] = line % 2 == 0 ? -1.0f : 1.0f;
    at_zero[at] = lives ? side[at] * from.at_zero : 0.0f;
    slope[at] = lives ? side[at] * from.slope : 0.0f;
    across[i][at] = side[at];
    across[1 - i][at] = 0.0f;
    origin[at] = frame.origin[a];
    inv_cell_size[at] = frame.inv_cell_size[a];
    last[at] = static_cast<float>(frame.resolution[a] - 1);
  }
};

}  // namespace raymeter
