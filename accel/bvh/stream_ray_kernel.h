#pragma once

// A stream: rays of a slice sorted by the octant of their directions, and groups of them that go through the hierarchy together.

#include "accel/bvh/stream_layout.h"
#include "core/ray/packet_loop.h"
#include "core/simd/shuffle_kernel.h"

namespace raymeter {

inline constexpr int kGroupRays = kMaxPacket;

/// Writes a register of rays, lane i to sorted.ray[to[i]].
template <class L>
[[gnu::always_inline]] inline void store_records(const RayPacket<L>& from, typename L::Float t, const std::int32_t* to, std::int32_t count,
                                                 SortedRays& sorted) noexcept {
  using Float = typename L::Float;
  constexpr int kFields = sizeof(StreamRay) / sizeof(float);
  constexpr int kRows = L::kWidth >= 8 ? L::kWidth : kFields;  // are transposed at once
  const Float nearer(1.0f - kSlabPadding), farther(-1.0f - kSlabPadding);
  Float field[kFields];
  for (int a = 0; a < 3; ++a) {
    field[2 * a] = from.inv_dir[a] * nearer;
    field[2 * a + 1] = from.inv_dir[a] * farther;
    field[8 + a] = from.org[a];
    field[12 + a] = from.shear[a];
  }
  field[6] = from.t_min;
  field[7] = -t;
  field[11] = from.slab_slack + from.slab_slack;
  field[15] = Float(0.0f);
  for (int f = 0; f < kFields; f += kRows) {
    if constexpr (L::kWidth >= 8) {
      Float(&rows)[kRows] = *reinterpret_cast<Float(*)[kRows]>(field + f);
      LaneShuffles<L::kIsa>::transpose(rows);
      for (std::int32_t lane = 0; lane < count; ++lane) L::store(reinterpret_cast<float*>(&sorted.ray[to[lane]]) + f, rows[lane]);
    } else {
      const auto* const lanes = reinterpret_cast<const float*>(field);
      for (std::int32_t lane = 0; lane < count; ++lane) {
        auto* const record = reinterpret_cast<float*>(&sorted.ray[to[lane]]);
        for (int r = 0; r < kRows; ++r) record[r] = lanes[r * L::kWidth + lane];
      }
    }
  }
}

/// The same for lines.
template <class L>
[[gnu::always_inline]] inline void store_lines(const RayPacket<L>& from, const std::int32_t* to, std::int32_t count, SortedRays& sorted) noexcept {
  using Float = typename L::Float;
  constexpr int kRows = L::kWidth >= 8 ? L::kWidth : 8;
  Float field[kRows];
  for (int f = 7; f < kRows; ++f) field[f] = Float(0.0f);
  for (int a = 0; a < 3; ++a) {
    field[a] = from.dir[a];
    field[4 + a] = from.inv_dir[a];
  }
  field[3] = from.inv_length2;
  if constexpr (L::kWidth >= 8) {
    LaneShuffles<L::kIsa>::transpose(field);
    for (std::int32_t lane = 0; lane < count; ++lane) LaneShuffles<L::kIsa>::store_eight(reinterpret_cast<float*>(&sorted.line[to[lane]]), field[lane]);
  } else {
    const auto* const lanes = reinterpret_cast<const float*>(field);
    for (std::int32_t lane = 0; lane < count; ++lane) {
      auto* const record = reinterpret_cast<float*>(&sorted.line[to[lane]]);
      for (int r = 0; r < 8; ++r) record[r] = lanes[r * L::kWidth + lane];
    }
  }
}

/// The bins of at most kStreamRays rays: octant + 8 * axis, as load_group() finds it. Of invalid rays any.
template <class L>
void find_bins(const RayView& rays, std::int32_t (&bin)[kStreamRays]) noexcept {
  using Float = typename L::Float;
  using Int = typename L::Int;
  for (std::int32_t first = 0; first < rays.count; first += L::kWidth) {
    Float size[3];
    Int signs(0);
    for (int a = 0; a < 3; ++a) {
      const Float dir = L::load(rays.dir[a] + first);
      size[a] = L::abs(dir);
      signs = signs + L::select(L::negative(dir), Int(1 << a), Int(0));
    }
    const auto is_z = (size[2] >= size[0]) & (size[2] >= size[1]);
    const Int axis = L::select(is_z, Int(16), L::select(size[1] >= size[0], Int(8), Int(0)));
    L::store(bin + first, signs + axis);
  }
}

/// Sorts at most kStreamRays rays by bin, keeping their order inside one.
template <class L>
void sort_by_bin(const RayView& rays, bool lines, SortedRays& sorted) noexcept {
  std::int32_t bin[kStreamRays];
  std::int32_t next[kStreamBins + 1] = {};
  find_bins<L>(rays, bin);
  for (std::int32_t i = 0; i < rays.count; ++i) ++next[bin[i] + 1];
  for (int b = 0; b < kStreamBins; ++b) next[b + 1] += next[b];
  for (int b = 0; b <= kStreamBins; ++b) sorted.first[b] = next[b];
  for (std::int32_t first = 0; first < rays.count; first += L::kWidth) {
    const std::int32_t left = rays.count - first;
    const std::int32_t count = left < L::kWidth ? left : L::kWidth;
    RayPacket<L> ray;
    HitPacket<L> hit;
    load_group(rays, first, count, ray, hit);
    alignas(64) float t_unit[L::kWidth];
    L::store(t_unit, ray.t_unit);
    std::int32_t to[L::kWidth];
    for (std::int32_t lane = 0; lane < count; ++lane) {
      to[lane] = next[bin[first + lane]]++;
      sorted.source[to[lane]] = first + lane;
      sorted.t_unit[to[lane]] = t_unit[lane];
    }
    store_records<L>(ray, hit.t, to, count, sorted);
    if (lines) store_lines<L>(ray, to, count, sorted);
  }
}

/// Up to kGroupRays rays of one bin, and what they have met.
template <class L>
struct StreamGroup {
  StreamRay* ray;
  const StreamLine* line;
  std::int32_t count;
  std::uint32_t octant;
  std::uint32_t order;  ///< the octant in whose order children are visited
  StreamAxes axes;
  std::uint64_t alive;  ///< rays that can still be improved
  alignas(64) std::int32_t prim[kGroupRays];
  alignas(64) float u[kGroupRays];
  alignas(64) float v[kGroupRays];
  Packet<L, 0> packet;  ///< for the tests of primitives that are no triangles
  bool has_packet;

  void start(SortedRays& sorted, std::int32_t first, std::int32_t size, std::uint32_t bin) noexcept {
    ray = sorted.ray + first;
    line = sorted.line + first;
    count = size;
    octant = octant_of_bin(bin);
    order = octant;
    axes = axes_of_bin(bin);
    alive = 0;
    has_packet = false;
    for (int i = 0; i < kGroupRays; i += L::kWidth) {
      L::store(prim + i, typename L::Int(kNoPrim));
      L::store(u + i, typename L::Float(0.0f));
      L::store(v + i, typename L::Float(0.0f));
    }
    for (std::int32_t i = 0; i < count; ++i) alive |= std::uint64_t{ray[i].interval[1] < kInfinity} << i;
  }
  /// Makes the packet of the batch's rays, `source[i]` being this group's ray i.
  void load_rays(const RayView& rays, const std::int32_t* source) noexcept {
    if (has_packet) return;
    has_packet = true;
    float column[8][2 * kGroupRays];  // a register is read past the end
    for (std::int32_t i = 0; i < count; ++i) {
      for (int a = 0; a < 3; ++a) {
        column[a][i] = rays.org[a][source[i]];
        column[a + 3][i] = rays.dir[a][source[i]];
      }
      column[6][i] = rays.t_min[source[i]];
      column[7][i] = rays.t_max[source[i]];
    }
    load_packet({{column[0], column[1], column[2]}, {column[3], column[4], column[5]}, column[6], column[7], count}, 0, count, packet);
  }
  /// Between the group's hits and those of the packet's register `g`.
  void to_packet(int g) noexcept {
    alignas(64) float t[L::kWidth];
    const int first = g * L::kWidth;
    for (int lane = 0; lane < L::kWidth; ++lane) t[lane] = first + lane < count ? -ray[first + lane].interval[1] : -kInfinity;
    packet.hit[g] = {L::load(t), L::load(prim + first), L::load(u + first), L::load(v + first)};
  }
  void from_packet(int g) noexcept {
    alignas(64) float t[L::kWidth];
    const int first = g * L::kWidth;
    L::store(t, packet.hit[g].t);
    for (int lane = 0; lane < L::kWidth && first + lane < count; ++lane) ray[first + lane].interval[1] = -t[lane];
    L::store(prim + first, packet.hit[g].prim);
    L::store(u + first, packet.hit[g].u);
    L::store(v + first, packet.hit[g].v);
  }
};

}  // namespace raymeter
