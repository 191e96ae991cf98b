#pragma once

// The beam of a packet: what bounds all its rays at once, so that one test decides for all of them.
//
// Along one axis k on which all live rays go the same way, ray j is the line x(c), c the coordinate along k. The lines through the least (greatest) x of all rays
// at the first and at the last plane that matter bound every ray between these planes, and need no corner rays (after Reshetov, Soupikov, Hurley 2005, who bound
// slopes at one plane; two planes keep the beam of rays that converge, as shadow rays do, slim).
//
// Conservative: with m the largest coordinate in play, a hit that a kernel accepts lies within e = kPrimitiveError (|P - org| + extent) <= 64 u m of its
// primitive's box, and that far from its ray along k too, where the ray moves by e times its slope. The planes are moved apart and the lines outwards by
// kBeamPadding m (1 + steepest slope): that, and the roundings of the lines themselves, whose coordinates are below m (1 + 2 slope).

#include "accel/bvh/wide_layout.h"
#include "core/geometry/error_bounds.h"
#include "core/ray/packet_loop.h"

namespace raymeter {

inline constexpr float kBeamPadding = 80 * kUnitRoundoff;
/// Rays must advance along the axis by at least this share (squared) of their length: a steeper beam is too wide to be of use.
inline constexpr float kBeamLeastAdvance2 = 0.09f;
/// Where the beam is wider than this share of the scene, it meets many nodes that no ray of it meets: then the rays are tested at inner nodes too.
inline constexpr float kSlimBeam = 0.02f;

/// A line x(c) = at_zero + slope c that bounds the rays, and the row of a node's planes in which a child's outermost c for this line stands.
struct BeamLine {
  float at_zero;
  float slope;
  int row;
};

/// What bounds all rays of a packet; c is the plain coordinate along `axis`, whichever way the rays go.
struct Beam {
  int axis = -1;          ///< k; -1: the rays have no beam in common
  int across[2];          ///< the other two axes
  float sign;             ///< of the rays' direction along k
  float begin, end;       ///< planes between which hits can lie, times `sign`
  BeamLine low[2];        ///< of the least x, by `across`
  BeamLine high[2];       ///< of the greatest
  float padding;
  bool slim = false;
  /// The row of a node's planes that rays meet first (last) along the axis.
  [[nodiscard]] int first_row() const noexcept { return sign > 0 ? axis : axis + 3; }
  [[nodiscard]] int last_row() const noexcept { return sign > 0 ? axis + 3 : axis; }
};

/// The last plane at which a live ray can still find a nearer hit; -inf where none lives.
template <class L, int kGroups>
inline float farthest_plane(const Beam& beam, const Packet<L, kGroups>& packet) noexcept {
  using Float = typename L::Float;
  Float plane(-kInfinity);
  for (int g = 0; g < packet.group_count(); ++g) {
    const RayPacket<L>& ray = packet.ray[g];
    plane = L::max(L::mul_add(packet.hit[g].t, L::abs(ray.dir[beam.axis]), Float(beam.sign) * ray.org[beam.axis]), plane);
  }
  const float farthest = L::reduce_max(plane) + beam.padding;
  return farthest < beam.end ? farthest : beam.end;
}

/// Sets the axis that the live rays advance along the most, and its sign; leaves -1 where there is none with the same sign and enough advance.
template <class L, int kGroups>
inline void pick_axis(const Packet<L, kGroups>& packet, Beam& beam) noexcept {
  using Float = typename L::Float;
  float best = kBeamLeastAdvance2;
  for (int a = 0; a < 3; ++a) {
    Float least(kInfinity);
    std::uint32_t forward = 0, backward = 0;
    for (int g = 0; g < packet.group_count(); ++g) {
      const RayPacket<L>& ray = packet.ray[g];
      const auto live = packet.live(g);
      const std::uint32_t negative = L::bits(live & ray.negative[a]);
      backward |= negative;
      forward |= negative ^ L::bits(live);
      least = L::min(L::select(live, ray.dir[a] * ray.dir[a] * ray.inv_length2, Float(kInfinity)), least);
    }
    if ((forward == 0) == (backward == 0)) continue;
    const float advance2 = L::reduce_min(least);
    if (!(advance2 > best)) continue;
    best = advance2;
    beam.axis = a;
    beam.sign = backward != 0 ? -1.0f : 1.0f;
  }
}

/// Sets the planes between which the live rays, inside the box (min x y z, max x y z), can meet anything.
template <class L, int kGroups>
inline void set_planes(const Packet<L, kGroups>& packet, const float* box, Beam& beam) noexcept {
  using Float = typename L::Float;
  Float first(kInfinity), last(-kInfinity);
  for (int g = 0; g < packet.group_count(); ++g) {
    const RayPacket<L>& ray = packet.ray[g];
    const Float start = Float(beam.sign) * ray.org[beam.axis];
    const Float advance = L::abs(ray.dir[beam.axis]);
    first = L::min(L::select(packet.live(g), L::mul_add(ray.t_min, advance, start), Float(kInfinity)), first);
    last = L::max(L::mul_add(packet.hit[g].t, advance, start), last);
  }
  const float box_begin = beam.sign * box[beam.first_row()], box_end = beam.sign * box[beam.last_row()];
  const float first_plane = L::reduce_min(first), last_plane = L::reduce_max(last);
  beam.begin = first_plane > box_begin ? first_plane : box_begin;
  beam.end = last_plane < box_end ? last_plane : box_end;
  if (!(beam.begin <= beam.end)) beam.end = beam.begin;  // outside, or within the padding
}

/// The beam of the packet's live rays; axis -1 where they have none.
template <class L, int kGroups>
inline Beam make_beam(const Packet<L, kGroups>& packet, const float* box) noexcept {
  using Float = typename L::Float;
  Beam beam;
  pick_axis(packet, beam);
  if (beam.axis < 0) return beam;
  const int k = beam.axis;
  beam.across[0] = k == 0 ? 1 : 0;
  beam.across[1] = k == 2 ? 1 : 2;
  set_planes(packet, box, beam);

  const auto greater = [](float a, float b) noexcept { return a > b ? a : b; };
  float magnitude = 0, extent = 0;
  for (int a = 0; a < 3; ++a) {
    magnitude = greater(greater(__builtin_fabsf(box[a]), __builtin_fabsf(box[a + 3])), magnitude);
    extent = greater(box[a + 3] - box[a], extent);
  }
  Float largest(0.0f), steepest(0.0f);
  for (int g = 0; g < packet.group_count(); ++g) {
    const RayPacket<L>& ray = packet.ray[g];
    const Float advance = L::abs(ray.inv_dir[k]);
    for (int a = 0; a < 3; ++a) largest = L::max(L::abs(ray.org[a]), largest);  // dead lanes have the origin 0 and the direction (1, 1, 1)
    for (const int a : beam.across) steepest = L::max(L::abs(ray.dir[a]) * advance, steepest);
  }
  const float steep = 1.0f + L::reduce_max(steepest);
  magnitude = greater(L::reduce_max(largest), magnitude);
  beam.padding = kBeamPadding * magnitude * steep;
  if (!(beam.padding < kInfinity)) return Beam{};
  beam.begin -= beam.padding;
  beam.end += beam.padding;

  const float per_length = 1.0f / greater(beam.end - beam.begin, 0x1p-126f);
  float width = 0;
  for (int i = 0; i < 2; ++i) {
    const int a = beam.across[i];
    Float least[2] = {Float(kInfinity), Float(kInfinity)}, greatest[2] = {Float(-kInfinity), Float(-kInfinity)};
    for (int g = 0; g < packet.group_count(); ++g) {
      const RayPacket<L>& ray = packet.ray[g];
      const auto live = packet.live(g);
      const Float slope = ray.dir[a] * L::abs(ray.inv_dir[k]);
      const Float start = Float(beam.sign) * ray.org[k];
      for (int e = 0; e < 2; ++e) {
        const Float x = L::mul_add(Float(e == 0 ? beam.begin : beam.end) - start, slope, ray.org[a]);
        least[e] = L::min(L::select(live, x, Float(kInfinity)), least[e]);
        greatest[e] = L::max(L::select(live, x, Float(-kInfinity)), greatest[e]);
      }
    }
    const float low_begin = L::reduce_min(least[0]) - beam.padding, low_end = L::reduce_min(least[1]) - beam.padding;
    const float high_begin = L::reduce_max(greatest[0]) + beam.padding, high_end = L::reduce_max(greatest[1]) + beam.padding;
    width = greater(width, greater(high_begin - low_begin, high_end - low_end));
    const auto line = [&](float x_begin, float x_end, bool rising_first) noexcept {
      const float slope = (x_end - x_begin) * per_length;  // along the rays
      return BeamLine{x_begin - slope * beam.begin, beam.sign * slope, (slope >= 0) == rising_first ? beam.first_row() : beam.last_row()};
    };
    beam.low[i] = line(low_begin, low_end, true);
    beam.high[i] = line(high_begin, high_end, false);
  }
  if (!(width < kInfinity)) return Beam{};
  beam.slim = width <= kSlimBeam * extent;
  return beam;
}

/// Which of a node's children the beam meets before the plane `farthest`, as bits.
template <class L>
inline std::uint32_t children_met(const Beam& beam, const WideNode& node, float farthest) noexcept {
  using Float = typename L::Float;
  constexpr int kStep = L::kWidth < kWideChildren ? L::kWidth : kWideChildren;
  const float least = beam.sign > 0 ? beam.begin : -farthest, greatest = beam.sign > 0 ? farthest : -beam.begin;
  std::uint32_t met = 0;
  for (int c = 0; c < kWideChildren; c += kStep) {  // a wider register reads on into the next row, to no effect
    auto inside = (L::load(node.plane[beam.axis] + c) <= Float(greatest)) & (L::load(node.plane[beam.axis + 3] + c) >= Float(least));
    for (int i = 0; i < 2; ++i) {
      const int a = beam.across[i];
      const BeamLine &low = beam.low[i], &high = beam.high[i];
      inside = inside & (L::load(node.plane[a + 3] + c) >= L::mul_add(Float(low.slope), L::load(node.plane[low.row] + c), Float(low.at_zero))) &
               (L::load(node.plane[a] + c) <= L::mul_add(Float(high.slope), L::load(node.plane[high.row] + c), Float(high.at_zero)));
    }
    met |= (L::bits(inside) & ((1u << kStep) - 1)) << c;
  }
  return met;
}

/// The block's triangles that are not wholly outside one side of the beam; returns how many.
template <class L>
inline std::int32_t triangles_met(const Beam& beam, const TriangleBlock& block, float farthest, std::int32_t* triangle) noexcept {
  using Float = typename L::Float;
  using Int = typename L::Int;
  alignas(64) std::int32_t outside[TriangleBlock::kVertices + L::kWidth];
  const Int zero(0);
  const float least = beam.sign > 0 ? beam.begin : -farthest, greatest = beam.sign > 0 ? farthest : -beam.begin;
  for (int v = 0; v < TriangleBlock::kVertices; v += L::kWidth) {
    const Float plane = L::load(block.vertex[beam.axis] + v);
    Int sides = L::select(plane > Float(greatest), Int(1), zero) + L::select(plane < Float(least), Int(2), zero);
    for (int i = 0; i < 2; ++i) {
      const Float x = L::load(block.vertex[beam.across[i]] + v);
      sides = sides + L::select(x < L::mul_add(Float(beam.low[i].slope), plane, Float(beam.low[i].at_zero)), Int(4 << 2 * i), zero);
      sides = sides + L::select(x > L::mul_add(Float(beam.high[i].slope), plane, Float(beam.high[i].at_zero)), Int(8 << 2 * i), zero);
    }
    L::store(outside + v, sides);
  }
  std::int32_t count = 0;
  for (std::int32_t t = 0; t < block.count; ++t) {
    triangle[count] = t;
    count += (outside[block.corner[0][t]] & outside[block.corner[1][t]] & outside[block.corner[2][t]]) == 0 ? 1 : 0;
  }
  return count;
}

}  // namespace raymeter
