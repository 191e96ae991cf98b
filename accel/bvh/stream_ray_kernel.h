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
  using Int = typename L::Int;
  constexpr int kFields = sizeof(StreamRay) / sizeof(float);
  constexpr int kRows = L::kWidth >= 8 ? L::kWidth : kFields;  // are transposed at once
  const Int axis = L::select(from.axis_is_z, Int(2), L::select(from.axis_is_y, Int(1), Int(0)));
  Float field[kFields] = {from.inv_dir[0], -from.inv_dir[0], from.inv_dir[1], -from.inv_dir[1], from.inv_dir[2], -from.inv_dir[2], from.t_min,    -t,
                          from.org[0],     from.org[1],      from.org[2],     -from.slab_slack, from.shear[0],   from.shear[1],    from.shear[2], {}};
  L::store(reinterpret_cast<std::int32_t*>(&field[kFields - 1]), axis);
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

/// Sorts at most kStreamRays rays by octant, keeping their order inside one.
template <class L>
void sort_by_octant(const RayView& rays, SortedRays& sorted) noexcept {
  std::uint8_t octant[kStreamRays];
  std::int32_t next[9] = {};
  for (std::int32_t i = 0; i < rays.count; ++i) {
    std::uint32_t signs = 0;
    for (int a = 0; a < 3; ++a) signs |= __builtin_bit_cast(std::uint32_t, rays.dir[a][i]) >> 31 << a;
    octant[i] = static_cast<std::uint8_t>(signs);
  }
  for (std::int32_t i = 0; i < rays.count; ++i) ++next[octant[i] + 1];
  for (int o = 0; o < 8; ++o) next[o + 1] += next[o];
  for (int o = 0; o < 9; ++o) sorted.first[o] = next[o];
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
      to[lane] = next[octant[first + lane]]++;
      sorted.source[to[lane]] = first + lane;
      sorted.t_unit[to[lane]] = t_unit[lane];
    }
    store_records<L>(ray, hit.t, to, count, sorted);
  }
}

/// Up to kGroupRays rays of one octant, and what they have met.
template <class L>
struct StreamGroup {
  StreamRay* ray;
  std::int32_t count;
  std::uint32_t octant;
  std::uint64_t alive;  ///< rays that can still be improved
  alignas(64) std::int32_t prim[kGroupRays];
  alignas(64) float u[kGroupRays];
  alignas(64) float v[kGroupRays];
  Packet<L, 0> packet;  ///< for the tests of primitives that are no triangles
  bool has_packet;

  void start(StreamRay* rays, std::int32_t size, std::uint32_t of_octant) noexcept {
    ray = rays;
    count = size;
    octant = of_octant;
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
