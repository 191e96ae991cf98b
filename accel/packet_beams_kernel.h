#pragma once

// The beams of a packet, of sixteen rays each, side by side in registers: one pass says which of them a primitive is outside of.

#include "accel/beam_kernel.h"
#include "accel/beam_layout.h"
#include "core/scene/pools_view.h"
#include "core/scene/primitive.h"

namespace raymeter {

inline constexpr int kBeams = kMaxPacket / kBeamRays;

/// Each beam has four lines: below and above its rays on the one axis across, then on the other. They stand in the lanes of registers, pointing outwards: a
/// point (x, c) is outside where side x > slope c + at_zero.
template <class L, int kGroups>
struct PacketBeams {
  static constexpr int kLines = 4 * kBeams;
  static constexpr int kStep = L::kWidth < kLines ? L::kWidth : kLines;
  Packet<L, kGroups> rays[kBeams];
  Beam beam[kBeams];
  float farthest[kBeams];  ///< farthest_plane() of each
  int count = 0;
  std::uint32_t alive = 0;   ///< beams that may still meet something, as bits
  int axis[3] = {};          ///< the two axes across, and the one along the beams
  float begin = 0, end = 0;  ///< coordinates between which hits can lie, the lesser first
  float sign = 1;            ///< of the rays' directions along the axis
  alignas(64) float at_zero[kLines];
  alignas(64) float slope[kLines];
  alignas(64) float side[kLines];       ///< -1 below, 1 above
  alignas(64) float across[2][kLines];  ///< `side` for the lines of this axis, else 0

  /// Loads `rays_wanted` rays from `first` on, at most kMaxPacket.
  void load(const RayView& from, std::int32_t first, std::int32_t rays_wanted) noexcept {
    count = 0;
    for (std::int32_t r = 0; r < rays_wanted; r += kBeamRays) load_packet(from, first + r, in_beam(rays_wanted, r), rays[count++]);
  }
  template <Query Q>
  void store(const TraceArgs& args, std::int32_t first, std::int32_t rays_wanted) const noexcept {
    for (std::int32_t r = 0; r < rays_wanted; r += kBeamRays) store_packet<Q>(args, first + r, in_beam(rays_wanted, r), rays[r / kBeamRays]);
  }

  void update_farthest(int b) noexcept { farthest[b] = farthest_plane(beam[b], rays[b]); }

  /// Sets `alive`.
  void find_alive() noexcept {
    alive = 0;
    for (int b = 0; b < count; ++b) {
      bool lives = false;
      for (int g = 0; g < rays[b].group_count(); ++g) lives |= L::any(rays[b].live(g));
      alive |= (lives ? 1u : 0u) << b;
    }
  }
  /// Makes the beams that are alive, along an axis on which `whole` says that all rays go the same way, inside a box (min x y z, max x y z) around all that can
  /// be hit. Returns whether they are finite.
  bool make(const float* box, Beam whole) noexcept {
    set_planes(rays, count, box, whole);
    for (int i = 0; i < 2; ++i) axis[i] = whole.across[i];
    axis[2] = whole.axis;
    begin = whole.least(whole.end);
    end = whole.greatest(whole.end);
    sign = whole.sign;
    for (int b = 0; b < kBeams; ++b) {
      beam[b] = whole;
      if ((alive >> b & 1) != 0) {
        if (!set_lines(beam_ends(rays[b], whole), 1.0f, beam[b])) return false;
        update_farthest(b);
      }
      for (int line = 0; line < 4; ++line) draw(b, line);
    }
    return true;
  }

  /// The beams, as bits, that do not have the whole triangle, or the box of another primitive, outside one of their lines.
  [[nodiscard]] std::uint32_t that_meet(const PoolsView& pools, PrimKind kind, std::int32_t index) const noexcept {
    if (kind == PrimKind::triangle) return that_meet(pools.triangles, index);
    float low[3], high[3];
    for (int a = 0; a < 3; ++a) {
      switch (kind) {
        case PrimKind::triangle: break;
        case PrimKind::sphere:
          low[a] = pools.spheres.center[a][index] - pools.spheres.radius[index];
          high[a] = pools.spheres.center[a][index] + pools.spheres.radius[index];
          break;
        case PrimKind::polygon:
          low[a] = pools.polygons.box_min[a][index];
          high[a] = pools.polygons.box_max[a][index];
          break;
        case PrimKind::cone:
          low[a] = pools.cones.box_min[a][index];
          high[a] = pools.cones.box_max[a][index];
          break;
      }
    }
    return that_meet(low, high);
  }

private:
  [[nodiscard]] static std::int32_t in_beam(std::int32_t rays_wanted, std::int32_t first) noexcept {
    return rays_wanted - first < kBeamRays ? rays_wanted - first : kBeamRays;
  }
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
  /// The beams that have no line of which outside(at_zero, slope, across[0], across[1]) is true.
  template <class Outside>
  [[nodiscard]] [[gnu::always_inline]] std::uint32_t beams_within(Outside outside) const noexcept {
    std::uint32_t lines = 0;
    for (int line = 0; line < 4 * count; line += kStep) {
      const auto beyond = outside(L::load(at_zero + line), L::load(slope + line), L::load(across[0] + line), L::load(across[1] + line));
      lines |= (L::bits(beyond) & ((1u << kStep) - 1u)) << line;
    }
    std::uint32_t met = 0;
    for (int b = 0; b < kBeams; ++b) met |= ((lines >> 4 * b & 0xFu) == 0 ? 1u : 0u) << b;
    return met & alive;
  }
  void draw(int b, int line) noexcept {
    const bool lives = (alive >> b & 1) != 0;
    const int i = line / 2, at = 4 * b + line;
    const BeamLine& from = line % 2 == 0 ? beam[b].low[i] : beam[b].high[i];
    side[at] = line % 2 == 0 ? -1.0f : 1.0f;
    at_zero[at] = lives ? side[at] * from.at_zero : 0.0f;
    slope[at] = lives ? side[at] * from.slope : 0.0f;
    across[i][at] = side[at];
    across[1 - i][at] = 0.0f;
  }
};

}  // namespace raymeter
