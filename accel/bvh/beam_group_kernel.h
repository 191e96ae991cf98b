#pragma once

// Up to 256 rays in beams of up to sixteen, slim enough to cull single triangles. A beam around all of them is tested against a node's children first, and the
// beams themselves, side by side in a register, against the children that it meets.

#include "accel/bvh/beam_node_kernel.h"

namespace raymeter {

inline constexpr int kMaxBeams = kMaxGroupRays / kBeamRays;
/// Beams wider together than this share of the scene part early: then they are no group. Those of rays that any hit ends part sooner.
template <Query Q>
inline constexpr float kSlimGroup = Q == Query::closest ? 0.1f : kSlimBeam;

template <class L, int kGroups>
struct BeamGroup {
  static constexpr int kRow = kMaxBeams > L::kWidth ? kMaxBeams : L::kWidth;
  Packet<L, kGroups> rays[kMaxBeams];
  Beam beam[kMaxBeams];
  Beam whole;  ///< around all of them
  int count = 0;
  std::uint32_t alive = 0;             ///< beams with a live ray, as bits
  alignas(64) float farthest[kRow];    ///< farthest_plane() of each
  alignas(64) float at_zero[4][kRow];  ///< their lines low[0], low[1], high[0], high[1]
  alignas(64) float slope[4][kRow];

  /// Makes the beams inside `box`. Returns whether they have one in common, no wider than `slim` of the box; where they have not, each has its own, or none.
  bool make_beams(const float* box, float slim) noexcept {
    float extent = 0;
    for (int a = 0; a < 3; ++a) extent = box[a + 3] - box[a] > extent ? box[a + 3] - box[a] : extent;
    alive = 0;
    for (int p = 0; p < count; ++p) {
      bool lives = false;
      for (int g = 0; g < rays[p].group_count(); ++g) lives |= L::any(rays[p].live(g));
      alive |= (lives ? 1u : 0u) << p;
    }
    if (count > 1 && alive != 0 && make_common(box, extent, slim)) return true;
    for (int p = 0; p < count; ++p) make_own(p, box, extent);
    return false;
  }
  void update_farthest(int p) noexcept {
    if (beam[p].axis >= 0) farthest[p] = farthest_plane(beam[p], rays[p]);
  }
  [[nodiscard]] float farthest_of_all() const noexcept {
    auto all = L::load(farthest);
    for (int p = L::kWidth; p < kMaxBeams; p += L::kWidth) all = L::max(L::load(farthest + p), all);
    return L::reduce_max(all);
  }
  /// The beams, as bits, that can still find something at or behind a plane (times their sign).
  [[nodiscard]] std::uint32_t reach(float plane) const noexcept {
    std::uint32_t beams = 0;
    for (int p = 0; p < kMaxBeams; p += L::kWidth) beams |= L::bits(typename L::Float(plane) <= L::load(farthest + p)) << p;
    return beams;
  }

private:
  bool make_common(const float* box, float extent, float slim) noexcept {
    whole = Beam{};
    pick_axis(rays, count, whole);
    if (whole.axis < 0) return false;
    set_planes(rays, count, box, whole);
    BeamEnds all{{{kInfinity, kInfinity}, {kInfinity, kInfinity}}, {{-kInfinity, -kInfinity}, {-kInfinity, -kInfinity}}};
    for (int p = 0; p < kMaxBeams; ++p) {
      farthest[p] = -kInfinity;
      if ((alive >> p & 1) == 0) continue;
      beam[p] = whole;
      const BeamEnds ends = beam_ends(rays[p], whole);
      if (!set_lines(ends, extent, beam[p])) return false;
      for (int i = 0; i < 2; ++i) {
        at_zero[i][p] = beam[p].low[i].at_zero;
        slope[i][p] = beam[p].low[i].slope;
        at_zero[i + 2][p] = beam[p].high[i].at_zero;
        slope[i + 2][p] = beam[p].high[i].slope;
        for (int e = 0; e < 2; ++e) {
          all.least[i][e] = ends.least[i][e] < all.least[i][e] ? ends.least[i][e] : all.least[i][e];
          all.greatest[i][e] = ends.greatest[i][e] > all.greatest[i][e] ? ends.greatest[i][e] : all.greatest[i][e];
        }
      }
      update_farthest(p);
    }
    return set_lines(all, slim / kSlimBeam * extent, whole) && whole.slim;
  }
  void make_own(int p, const float* box, float extent) noexcept {
    beam[p] = Beam{};
    farthest[p] = kInfinity;
    pick_axis(&rays[p], 1, beam[p]);
    if (beam[p].axis < 0) return;
    set_planes(&rays[p], 1, box, beam[p]);
    if (!set_lines(beam_ends(rays[p], beam[p]), extent, beam[p])) beam[p] = Beam{};
    update_farthest(p);
  }
};

/// Which of the given beams meet the child in `place`, as bits.
template <class L, int kGroups>
inline std::uint32_t beams_met(const BeamGroup<L, kGroups>& group, const WideNode& node, int place, std::uint32_t beams) noexcept {
  using Float = typename L::Float;
  const Beam& whole = group.whole;
  const Float least(node.plane[whole.axis][place]), greatest(node.plane[whole.axis + 3][place]), zero(0.0f);
  const Float first(whole.sign * node.plane[whole.first_row()][place]);
  std::uint32_t met = 0;
  for (int p = 0; p < kMaxBeams; p += L::kWidth) {
    const std::uint32_t lanes = beams >> p & ((1u << L::kWidth) - 1);
    if (lanes == 0) continue;
    auto inside = first <= L::load(group.farthest + p);
    for (int i = 0; i < 2; ++i) {
      const int a = whole.across[i];
      const Float low = L::load(group.slope[i] + p), high = L::load(group.slope[i + 2] + p);
      inside = inside & (Float(node.plane[a + 3][place]) >= L::mul_add(low, L::select(low >= zero, least, greatest), L::load(group.at_zero[i] + p))) &
               (Float(node.plane[a][place]) <= L::mul_add(high, L::select(high >= zero, greatest, least), L::load(group.at_zero[i + 2] + p)));
    }
    met |= (L::bits(inside) & lanes) << p;
  }
  return met;
}

}  // namespace raymeter
