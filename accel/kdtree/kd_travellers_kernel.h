#pragma once

// A packet on its way through a k-d tree: its rays' intervals, the children that wait, bounds on all rays. kd_kernel.cpp has the proof.

#include "accel/kdtree/kd_layout.h"
#include "accel/packet_mailbox_kernel.h"
#include "core/bounds/slab_kernel.h"
#include "core/ray/packet_loop.h"
#include "core/stats/policy.h"

namespace raymeter {

/// Leaves of well divided trees are short, and those that list a primitive follow each other.
using KdMailbox = PacketMailbox<16>;

/// Far children that wait, and the intervals of the rays in them: [entry][near, far][group][lane].
template <class L, int kGroups>
struct KdStack {
  float* rows;
  std::uint64_t* groups;  // with live rays
  KdSpan* span;
  std::int32_t* node;
  std::int32_t row_floats;
  std::int32_t size = 0;

  KdStack(std::byte* scratch, std::int32_t capacity, std::int32_t group_count) noexcept
      : rows(reinterpret_cast<float*>(scratch)),
        groups(reinterpret_cast<std::uint64_t*>(rows + std::int64_t{2} * capacity * group_count * L::kWidth)),
        span(reinterpret_cast<KdSpan*>(groups + capacity)),
        node(reinterpret_cast<std::int32_t*>(span + capacity)),
        row_floats(group_count * L::kWidth) {}
  [[nodiscard]] float* near_of(std::int32_t entry, int group) const noexcept {
    return rows + std::int64_t{2} * entry * (kGroups > 0 ? kGroups * L::kWidth : row_floats) + group * L::kWidth;
  }
  [[nodiscard]] float* far_of(std::int32_t entry, int group) const noexcept { return near_of(entry, group) + (kGroups > 0 ? kGroups * L::kWidth : row_floats); }
};

/// What bounds all rays of a packet, times the sign of their directions, so that they go up.
struct KdFrustum {
  KdSpan span;  ///< in the node reached
  float sign[3];
  float near_org[3];  ///< the least
  float far_org[3];   ///< the greatest
  float inverse_min[3], inverse_max[3];

  /// No ray passes the plane's far side later, none its near side earlier. Rounding is monotonic, so that this holds of what is computed for rays.
  [[nodiscard]] KdSpan crossing(std::int32_t axis, float plane) const noexcept {
    const float enter = sign[axis] * plane - far_org[axis], leave = sign[axis] * plane - near_org[axis];
    return {enter * (enter >= 0 ? inverse_min[axis] : inverse_max[axis]), leave * (leave >= 0 ? inverse_max[axis] : inverse_min[axis])};
  }
};

/// A packet under way: where its rays are in the node that it has reached. Intervals mean something in registers of `groups` only, and are empty where a ray is
/// not in the node.
template <class L, int kGroups>
struct KdTravellers {
  using Float = typename L::Float;
  static constexpr int kCapacity = Packet<L, kGroups>::kCapacity;

  Packet<L, kGroups>& packet;
  Float near_org[3][kCapacity];  ///< the origin moved back by the margin: meets a plane when its far side has been passed
  Float far_org[3][kCapacity];   ///< moved ahead
  Float t_near[kCapacity];
  Float t_far[kCapacity];
  std::uint64_t groups = 0;
  std::int32_t order = 0;  ///< bit per axis: most rays go down it

  KdTravellers(const KdView& tree, Packet<L, kGroups>& p) noexcept : packet(p) {
    std::int32_t down[3] = {}, live_count = 0;
    for (int g = 0; g < packet.group_count(); ++g) {
      const RayPacket<L>& ray = packet.ray[g];
      const SlabInterval<L> inside = intersect_box(ray, packet.hit[g].t, BoxPlanes<L, false>(tree.box, 0));
      t_near[g] = inside.t_near;
      t_far[g] = inside.t_far;
      const std::uint32_t live = L::bits(t_near[g] <= t_far[g]);
      if (live == 0) continue;
      groups |= std::uint64_t{1} << g;
      live_count += __builtin_popcount(live);
      const Float speed = L::abs(ray.dir[0]) + L::abs(ray.dir[1]) + L::abs(ray.dir[2]);
      const Float reach = speed * L::max(L::abs(t_near[g]), L::abs(t_far[g]));
      for (int a = 0; a < 3; ++a) {
        const Float margin = Float(48 * kUnitRoundoff) * (reach + Float(tree.largest_size)) + Float(2 * kUnitRoundoff) * L::abs(ray.org[a]);
        const Float ahead = L::select(ray.negative[a], -margin, margin);
        near_org[a][g] = ray.org[a] - ahead;
        far_org[a][g] = ray.org[a] + ahead;
        down[a] += __builtin_popcount(L::bits(ray.negative[a]) & live);
      }
    }
    for (int a = 0; a < 3; ++a) order |= 2 * down[a] > live_count ? 1 << a : 0;
  }

  [[nodiscard]] typename L::Mask live(int g) const noexcept { return t_near[g] <= t_far[g]; }

  /// Bounds of the packet as a whole, whose rays share their direction signs.
  void bound(KdFrustum& frustum) const noexcept {
    const Float none(kInfinity);
    frustum.span = {kInfinity, -kInfinity};
    for (int a = 0; a < 3; ++a) {
      const bool goes_down = (order >> a & 1) != 0;
      Float near_first = none, far_first = none, slowest = Float(0.0f), fastest = none;
      for_each_group([&](int g) noexcept {
        const typename L::Mask in = live(g);
        const Float inverse = L::abs(packet.ray[g].inv_dir[a]);
        near_first = L::min(L::select(in, goes_down ? -near_org[a][g] : near_org[a][g], none), near_first);
        far_first = L::min(L::select(in, goes_down ? far_org[a][g] : -far_org[a][g], none), far_first);
        slowest = L::max(L::select(in, inverse, Float(0.0f)), slowest);
        fastest = L::min(L::select(in, inverse, none), fastest);
      });
      frustum.sign[a] = goes_down ? -1.0f : 1.0f;
      frustum.near_org[a] = L::reduce_min(near_first);
      frustum.far_org[a] = -L::reduce_min(far_first);
      frustum.inverse_max[a] = L::reduce_max(slowest);
      frustum.inverse_min[a] = L::reduce_min(fastest);
    }
    for_each_group([&](int g) noexcept {
      const typename L::Mask in = live(g);
      const float begin = L::reduce_min(L::select(in, t_near[g], none)), end = L::reduce_max(L::select(in, t_far[g], -none));
      frustum.span = {begin < frustum.span.t_near ? begin : frustum.span.t_near, end > frustum.span.t_far ? end : frustum.span.t_far};
    });
  }

  /// Calls body(group) for each register with live rays.
  template <class Body>
  [[gnu::always_inline]] void for_each_group(Body body) const noexcept {
    if constexpr (kGroups == 1)
      body(0);
    else
      for (std::uint64_t left = groups; left != 0; left &= left - 1) body(__builtin_ctzll(left));
  }

  template <Event e, class Stats>
  void count_live(Stats stats) const noexcept {
    if constexpr (Stats::kCounting) for_each_group([&](int g) noexcept { stats.template count<e, L>(live(g)); });
  }
};

}  // namespace raymeter
