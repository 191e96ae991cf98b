#pragma once

// The beam of a packet: what bounds all its rays at once, so that one test decides for all of them.
//
// Along one axis k on which all live rays go the same way, ray j is the line x(c), c the coordinate along k. The lines through the least (greatest) x of all
// rays at the first and at the last plane that matter bound every ray between these planes, and need no corner rays (after Reshetov, Soupikov, Hurley 2005, who
// bound slopes at one plane; two planes keep the beam of rays that converge, as shadow rays do, slim).
//
// Conservative: with m the largest coordinate in play, a hit that a kernel accepts lies within e = kPrimitiveError (|P - org| + extent) <= 64 u m of its
// primitive's box, and that far from its ray along k too, where the ray moves by e times its slope. The planes are moved apart and the lines outwards by
// kBeamPadding m (1 + steepest slope): that, and the roundings of the lines themselves, whose coordinates are below m (1 + 2 slope).

#include "core/geometry/error_bounds.h"
#include "core/ray/packet_loop.h"

namespace raymeter {

inline constexpr float kBeamPadding = 80 * kUnitRoundoff;
/// Rays must advance along the axis by at least this share (squared) of their length: a steeper beam is too wide to be of use.
inline constexpr float kBeamLeastAdvance2 = 0.09f;
/// Where the beam is wider than this share of the scene, it meets many nodes that no ray of it meets: then the rays are tested at inner nodes too.
inline constexpr float kSlimBeam = 0.02f;

/// A line x(c) = at_zero + slope c.
struct BeamLine {
  float at_zero = 0;
  float slope = 0;
};

/// c is the plain coordinate along `axis`, whichever way the rays go.
struct Beam {
  int axis = -1;       ///< k; -1: the rays have no beam in common
  int across[2] = {};  ///< the other two axes
  float sign = 1;      ///< of the rays' direction along k
  float begin = 0;     ///< plane, times `sign`, from which hits can lie on
  float end = 0;       ///< and the one that they can lie up to
  float padding = 0;
  bool slim = false;
  BeamLine low[2];   ///< below all rays, by `across`
  BeamLine high[2];  ///< above all rays
  /// The row of a node's planes that rays meet first (last) along the axis.
  [[nodiscard]] int first_row() const noexcept { return sign > 0 ? axis : axis + 3; }
  [[nodiscard]] int last_row() const noexcept { return sign > 0 ? axis + 3 : axis; }
  /// The coordinates between which hits can lie, given the plane (times `sign`) that is the last for live rays.
  [[nodiscard]] float least(float farthest) const noexcept { return sign > 0 ? begin : -farthest; }
  [[nodiscard]] float greatest(float farthest) const noexcept { return sign > 0 ? farthest : -begin; }
};

/// Calls visit(ray, hit, live) for the registers of all packets.
template <class L, int kGroups, class Visit>
[[gnu::always_inline]] inline void for_each_register(const Packet<L, kGroups>* packets, int count, Visit visit) noexcept {
  for (int p = 0; p < count; ++p) {
    for (int g = 0; g < packets[p].group_count(); ++g) visit(packets[p].ray[g], packets[p].hit[g], packets[p].live(g));
  }
}

/// The last plane, times `sign`, at which a live ray can still find a nearer hit; -inf where none lives.
template <class L, int kGroups>
inline float farthest_plane(const Beam& beam, const Packet<L, kGroups>& packet) noexcept {
  using Float = typename L::Float;
  Float plane(-kInfinity);
  for_each_register(&packet, 1, [&](const RayPacket<L>& ray, const HitPacket<L>& hit, auto) noexcept {
    plane = L::max(L::mul_add(hit.t, L::abs(ray.dir[beam.axis]), Float(beam.sign) * ray.org[beam.axis]), plane);
  });
  const float farthest = L::reduce_max(plane) + beam.padding;
  return farthest < beam.end ? farthest : beam.end;
}

/// Sets the axis that the live rays advance along the most, and its sign; leaves -1 where there is none with the same sign and enough advance.
template <class L, int kGroups>
inline void pick_axis(const Packet<L, kGroups>* packets, int count, Beam& beam) noexcept {
  using Float = typename L::Float;
  Float advance2[3] = {Float(kInfinity), Float(kInfinity), Float(kInfinity)};
  std::uint32_t forward[3] = {}, backward[3] = {};
  for_each_register(packets, count, [&](const RayPacket<L>& ray, const HitPacket<L>&, auto live) noexcept {
    const std::uint32_t living = L::bits(live);
    for (int a = 0; a < 3; ++a) {
      const std::uint32_t negative = L::bits(ray.negative[a]) & living;
      backward[a] |= negative;
      forward[a] |= negative ^ living;
      advance2[a] = L::min(L::select(live, ray.dir[a] * ray.dir[a] * ray.inv_length2, Float(kInfinity)), advance2[a]);
    }
  });
  float best = kBeamLeastAdvance2;
  for (int a = 0; a < 3; ++a) {
    if ((forward[a] == 0) == (backward[a] == 0)) continue;
    const float least = L::reduce_min(advance2[a]);
    if (!(least > best)) continue;
    best = least;
    beam.axis = a;
    beam.sign = backward[a] != 0 ? -1.0f : 1.0f;
  }
  beam.across[0] = beam.axis == 0 ? 1 : 0;
  beam.across[1] = beam.axis == 2 ? 1 : 2;
}

/// Sets padding, and the planes between which the live rays, inside the box (min x y z, max x y z), can meet anything.
template <class L, int kGroups>
inline void set_planes(const Packet<L, kGroups>* packets, int count, const float* box, Beam& beam) noexcept {
  using Float = typename L::Float;
  const int k = beam.axis;
  Float first(kInfinity), last(-kInfinity), largest(0.0f), steepest(0.0f);
  for_each_register(packets, count, [&](const RayPacket<L>& ray, const HitPacket<L>& hit, auto live) noexcept {
    const Float start = Float(beam.sign) * ray.org[k];
    const Float advance = L::abs(ray.dir[k]);
    first = L::min(L::select(live, L::mul_add(ray.t_min, advance, start), Float(kInfinity)), first);
    last = L::max(L::mul_add(hit.t, advance, start), last);
    // Dead lanes have the origin 0 and the direction (1, 1, 1), or are rays of the beam.
    for (int a = 0; a < 3; ++a) largest = L::max(L::abs(ray.org[a]), largest);
    for (const int a : beam.across) steepest = L::max(L::abs(ray.dir[a] * ray.inv_dir[k]), steepest);
  });
  const auto greater = [](float a, float b) noexcept { return a > b ? a : b; };
  float magnitude = L::reduce_max(largest);
  for (int p = 0; p < 6; ++p) magnitude = greater(__builtin_fabsf(box[p]), magnitude);
  beam.padding = kBeamPadding * magnitude * (1.0f + L::reduce_max(steepest));
  const float first_plane = L::reduce_min(first), last_plane = L::reduce_max(last);
  const float box_begin = beam.sign * box[beam.first_row()], box_end = beam.sign * box[beam.last_row()];
  beam.begin = greater(first_plane, box_begin);
  beam.end = last_plane < box_end ? last_plane : box_end;
  if (!(beam.begin <= beam.end)) beam.end = beam.begin;  // outside, or within the padding
  beam.begin -= beam.padding;
  beam.end += beam.padding;
}

/// Where the beam is at its first and its last plane, with padding: least and greatest x [across][begin, end].
struct BeamEnds {
  float least[2][2];
  float greatest[2][2];
};

template <class L, int kGroups>
inline BeamEnds beam_ends(const Packet<L, kGroups>& packet, const Beam& beam) noexcept {
  using Float = typename L::Float;
  Float least[2][2], greatest[2][2];
  for (int i = 0; i < 2; ++i) {
    for (int e = 0; e < 2; ++e) {
      least[i][e] = Float(kInfinity);
      greatest[i][e] = Float(-kInfinity);
    }
  }
  for_each_register(&packet, 1, [&](const RayPacket<L>& ray, const HitPacket<L>&, auto live) noexcept {
    const Float per_plane = L::abs(ray.inv_dir[beam.axis]);
    const Float start = Float(beam.sign) * ray.org[beam.axis];
    const Float away[2] = {(Float(beam.begin) - start) * per_plane, (Float(beam.end) - start) * per_plane};
    for (int i = 0; i < 2; ++i) {
      const int a = beam.across[i];
      for (int e = 0; e < 2; ++e) {
        const Float x = L::mul_add(away[e], ray.dir[a], ray.org[a]);
        least[i][e] = L::min(L::select(live, x, Float(kInfinity)), least[i][e]);
        greatest[i][e] = L::max(L::select(live, x, Float(-kInfinity)), greatest[i][e]);
      }
    }
  });
  BeamEnds ends;
  for (int i = 0; i < 2; ++i) {
    for (int e = 0; e < 2; ++e) {
      ends.least[i][e] = L::reduce_min(least[i][e]) - beam.padding;
      ends.greatest[i][e] = L::reduce_max(greatest[i][e]) + beam.padding;
    }
  }
  return ends;
}

/// Draws the lines through the beam's ends. Returns false where the beam is not finite.
[[gnu::always_inline]] inline bool set_lines(const BeamEnds& ends, float scene_extent, Beam& beam) noexcept {
  const float length = beam.end - beam.begin;
  const float per_length = 1.0f / (length > 0x1p-126f ? length : 0x1p-126f);
  float width = 0;
  for (int i = 0; i < 2; ++i) {
    const auto line = [&](const float* x) noexcept {
      const float slope = (x[1] - x[0]) * per_length;  // along the rays
      return BeamLine{x[0] - slope * beam.begin, beam.sign * slope};
    };
    for (int e = 0; e < 2; ++e) width = ends.greatest[i][e] - ends.least[i][e] > width ? ends.greatest[i][e] - ends.least[i][e] : width;
    beam.low[i] = line(ends.least[i]);
    beam.high[i] = line(ends.greatest[i]);
    if (!(__builtin_fabsf(beam.low[i].at_zero) < kInfinity && __builtin_fabsf(beam.high[i].at_zero) < kInfinity)) return false;
  }
  beam.slim = width <= kSlimBeam * scene_extent;
  return width < kInfinity;
}

}  // namespace raymeter
