#pragma once

// Takes a slice apart into packets, and a packet into registers. A packet of `packet` rays is `group_count` registers that share one traversal:
// kGroups = 1 keeps them in registers, kGroups = 0 is any number known at run time.

#include <cstdint>

#include "core/geometry/error_bounds.h"
#include "core/ray/ray_packet.h"
#include "core/ray/trace_args.h"
#include "core/stats/policy.h"

namespace raymeter {

template <class L, int kGroups>
struct Packet {
  static constexpr int kCapacity = kGroups > 0 ? kGroups : (kMaxPacket + L::kWidth - 1) / L::kWidth;
  RayPacket<L> ray[kCapacity];
  HitPacket<L> hit[kCapacity];
  std::int32_t runtime_groups;

  [[nodiscard]] int group_count() const noexcept {
    if constexpr (kGroups > 0)
      return kGroups;
    else
      return runtime_groups;
  }
  /// The direction signs that all live rays share (0 where none lives), -1 where they differ.
  [[nodiscard]] std::int32_t shared_octant() const noexcept {
    std::int32_t shared = -1;
    for (int g = 0; g < group_count(); ++g) {
      if (L::none(live(g))) continue;
      if (ray[g].octant < 0 || (shared >= 0 && ray[g].octant != shared)) return -1;
      shared = ray[g].octant;
    }
    return shared >= 0 ? shared : 0;
  }
  /// Lanes that can still be improved.
  [[nodiscard]] typename L::Mask live(int group) const noexcept { return hit[group].t > typename L::Float(-kInfinity); }
};

/// Loads rays [first, first + count), count <= the register's width. Lanes beyond and invalid rays (NaN anywhere, infinite or zero vectors, t_min > t_max) are
/// dead.
template <class L>
inline void load_group(const RayView& rays, std::int32_t first, std::int32_t count, RayPacket<L>& ray, HitPacket<L>& hit) noexcept {
  using Float = typename L::Float;
  using Int = typename L::Int;
  using Mask = typename L::Mask;
  const Float zero(0.0f);
  Mask valid = L::less(L::iota(), Int(count));
  Mask moves = valid & ~valid;
  for (int a = 0; a < 3; ++a) {
    const Float org = L::load(rays.org[a] + first);
    const Float dir = L::load(rays.dir[a] + first);
    valid = valid & (org - org == zero) & (dir - dir == zero);
    moves = moves | (dir != zero);
    ray.org[a] = org;
    ray.dir[a] = dir;
  }
  const Float t_min = L::load(rays.t_min + first);
  const Float t_max = L::load(rays.t_max + first);
  valid = valid & moves & (t_min <= t_max);

  const Float one(1.0f);
  for (int a = 0; a < 3; ++a) {
    // Dead lanes get a harmless ray, so that no test sees their NaN.
    ray.org[a] = L::select(valid, ray.org[a], zero);
    ray.dir[a] = L::select(valid, ray.dir[a], one);
  }
  const Float longest = L::max(L::max(L::abs(ray.dir[0]), L::abs(ray.dir[1])), L::abs(ray.dir[2]));
  const Float scale = L::min(L::max(L::power_of_two(longest), Float(0x1p-126f)), Float(0x1p126f));
  ray.t_unit = one / scale;
  for (int a = 0; a < 3; ++a) {
    ray.dir[a] = ray.dir[a] * ray.t_unit;
    ray.inv_dir[a] = one / ray.dir[a];
    ray.negative[a] = L::negative(ray.dir[a]);
  }
  // Where the scaled ends underflow they are rounded inwards, so that no t outside the ray's own interval passes. A t beyond the largest float, on either side,
  // is no hit: an unbounded ray ends there, so that an overflow to infinity is not taken for one.
  const Float least(0x1p-149f);
  const Float begin = L::max(L::max(t_min, Float(-kLargest)) * scale, Float(-kLargest));
  ray.t_min = L::select(valid, L::select(begin * ray.t_unit < t_min, begin + least, begin), zero);
  ray.slab_slack = L::max(-ray.t_min, zero) * Float(2 * kSlabPadding);
  ray.inv_length2 = one / L::mul_add(ray.dir[2], ray.dir[2], L::mul_add(ray.dir[1], ray.dir[1], ray.dir[0] * ray.dir[0]));

  const Float size[3] = {L::abs(ray.dir[0]), L::abs(ray.dir[1]), L::abs(ray.dir[2])};
  ray.axis_is_z = (size[2] >= size[0]) & (size[2] >= size[1]);
  ray.axis_is_y = ~ray.axis_is_z & (size[1] >= size[0]);
  const auto pick = [&](Float x_major, Float y_major, Float z_major) noexcept {
    return L::select(ray.axis_is_z, z_major, L::select(ray.axis_is_y, y_major, x_major));
  };
  const Float major = pick(ray.dir[0], ray.dir[1], ray.dir[2]);
  ray.shear[0] = pick(ray.dir[1], ray.dir[2], ray.dir[0]) / major;
  ray.shear[1] = pick(ray.dir[2], ray.dir[0], ray.dir[1]) / major;
  ray.shear[2] = pick(ray.inv_dir[0], ray.inv_dir[1], ray.inv_dir[2]);
  ray.shear_org[0] = pick(ray.org[1], ray.org[2], ray.org[0]);
  ray.shear_org[1] = pick(ray.org[2], ray.org[0], ray.org[1]);
  ray.shear_org[2] = pick(ray.org[0], ray.org[1], ray.org[2]);

  const std::uint32_t live = L::bits(valid);
  const std::uint32_t y_bits = L::bits(ray.axis_is_y) & live;
  const std::uint32_t z_bits = L::bits(ray.axis_is_z) & live;
  ray.axis = (y_bits | z_bits) == 0 ? 0 : y_bits == live ? 1 : z_bits == live ? 2 : -1;
  ray.octant = 0;
  for (int a = 0; a < 3; ++a) {
    const std::uint32_t negative = L::bits(ray.negative[a]) & live;
    if (negative != 0 && negative != live)
      ray.octant = -1;
    else if (negative != 0 && ray.octant >= 0)
      ray.octant |= 1 << a;
  }

  const Float end = L::min(L::min(t_max, Float(kLargest)) * scale, Float(kLargest));
  hit.t = L::select(valid, L::select(end * ray.t_unit > t_max, end - least, end), Float(-kInfinity));
  hit.prim = Int(kNoPrim);
  hit.u = zero;
  hit.v = zero;
}

template <class L>
inline void store_closest(const HitView& hits, std::int32_t first, std::int32_t count, const RayPacket<L>& ray, const HitPacket<L>& hit) noexcept {
  using Float = typename L::Float;
  using Int = typename L::Int;
  const auto missed = L::equal(hit.prim, Int(kNoPrim));
  const Float t = L::select(missed, Float(kInfinity), hit.t * ray.t_unit);
  const Int prim = L::select(missed, Int(-1), hit.prim);
  if (count == L::kWidth) {
    L::store(hits.t + first, t);
    L::store(hits.prim + first, prim);
    L::store(hits.u + first, hit.u);
    L::store(hits.v + first, hit.v);
    return;
  }
  // A partial register must not touch its neighbours, which another thread may be writing.
  alignas(64) float t_lane[L::kWidth], u_lane[L::kWidth], v_lane[L::kWidth];
  alignas(64) std::int32_t prim_lane[L::kWidth];
  L::store(t_lane, t);
  L::store(prim_lane, prim);
  L::store(u_lane, hit.u);
  L::store(v_lane, hit.v);
  for (std::int32_t lane = 0; lane < count; ++lane) {
    hits.t[first + lane] = t_lane[lane];
    hits.prim[first + lane] = prim_lane[lane];
    hits.u[first + lane] = u_lane[lane];
    hits.v[first + lane] = v_lane[lane];
  }
}

template <class L>
inline void store_any(std::int32_t* blocker, std::int32_t first, std::int32_t count, const HitPacket<L>& hit) noexcept {
  using Int = typename L::Int;
  const Int prim = L::select(L::equal(hit.prim, Int(kNoPrim)), Int(-1), hit.prim);
  if (count == L::kWidth) {
    L::store(blocker + first, prim);
    return;
  }
  alignas(64) std::int32_t prim_lane[L::kWidth];
  L::store(prim_lane, prim);
  for (std::int32_t lane = 0; lane < count; ++lane) blocker[first + lane] = prim_lane[lane];
}

/// Loads `count` rays from `first` on.
template <class L, int kGroups>
inline void load_packet(const RayView& rays, std::int32_t first, std::int32_t count, Packet<L, kGroups>& packet) noexcept {
  packet.runtime_groups = (count + L::kWidth - 1) / L::kWidth;
  for (int g = 0; g < packet.group_count(); ++g) {
    const std::int32_t in_group = count - g * L::kWidth;
    load_group<L>(rays, first + g * L::kWidth, in_group < L::kWidth ? in_group : L::kWidth, packet.ray[g], packet.hit[g]);
  }
}

/// Stores what `count` rays from `first` on have met.
template <Query Q, class L, int kGroups>
inline void store_packet(const TraceArgs& args, std::int32_t first, std::int32_t count, const Packet<L, kGroups>& packet) noexcept {
  for (int g = 0; g < packet.group_count(); ++g) {
    const std::int32_t begin = first + g * L::kWidth;
    const std::int32_t in_group = count - g * L::kWidth;
    const std::int32_t stored = in_group < L::kWidth ? in_group : L::kWidth;
    if constexpr (Q == Query::closest)
      store_closest<L>(args.hits, begin, stored, packet.ray[g], packet.hit[g]);
    else
      store_any<L>(args.blocker, begin, stored, packet.hit[g]);
  }
}

/// Calls traverse(Packet<L, kGroups>&) for every packet of the slice and stores what it found.
template <Query Q, class L, int kGroups, class Traverse>
inline void for_each_packet(const TraceArgs& args, Traverse&& traverse) noexcept {
  Packet<L, kGroups> packet;
  for (std::int32_t first = 0; first < args.rays.count; first += args.packet) {
    const std::int32_t left = args.rays.count - first;
    const std::int32_t count = left < args.packet ? left : args.packet;
    load_packet(args.rays, first, count, packet);
    traverse(packet);
    store_packet<Q>(args, first, count, packet);
  }
}

/// Calls traverse.operator()<kGroups>() with 1 where a packet fits one register, else 0.
template <class L, class Traverse>
inline void with_groups(std::int32_t packet, Traverse&& traverse) noexcept {
  if (packet <= L::kWidth)
    traverse.template operator()<1>();
  else
    traverse.template operator()<0>();
}

}  // namespace raymeter
