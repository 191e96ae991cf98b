#pragma once

// The candidates of packets: which footprints may cover a packet's rectangle, from which depth on, and which lanes can still meet them there.

#include "accel/zbuffer/zbuffer_kernel.h"
#include "core/ray/packet_loop.h"
#include "core/stats/policy.h"

namespace raymeter {

inline constexpr int kSideBySide = 16;  ///< packets whose rectangles are tested together
inline constexpr int kChunk = 256;      ///< candidates that are looked at before packets' hits

/// Merges a cell's two lists, nearest first.
struct Candidates {
  const ZbufferView& frame;
  const CellArgs& cell;
  std::int32_t next[2] = {0, 0};

  [[nodiscard]] bool done() const noexcept { return next[0] == cell.list_size[0] && next[1] == cell.list_size[1]; }
  /// The list that the next candidate is in.
  [[nodiscard, gnu::always_inline]] int list() const noexcept {
    if (next[1] == cell.list_size[1]) return 0;
    if (next[0] == cell.list_size[0]) return 1;
    return nearest(1) > nearest(0) ? 1 : 0;
  }
  /// The next candidate of a list.
  [[nodiscard]] float nearest(int l) const noexcept { return frame.footprints[cell.near_list[l][next[l]]].nearest; }
  std::int32_t take() noexcept {
    const int l = list();
    return cell.near_list[l][next[l]++];
  }
};

/// Which of `count` packets from `first` on the footprint may cover, as bits.
template <class L, class Stats>
inline std::uint32_t packets_met(const Footprint& print, const CellArgs& cell, std::int32_t first, std::int32_t count, Stats stats) noexcept {
  using Float = typename L::Float;
  const float* const min_x = cell.rect[0] + first;
  const float* const max_x = cell.rect[1] + first;
  const float* const min_y = cell.rect[2] + first;
  const float* const max_y = cell.rect[3] + first;
  std::uint32_t met = 0;
  for (std::int32_t p = 0; p < count; p += L::kWidth) {
    auto inside = (L::load(max_x + p) >= Float(print.min_x)) & (L::load(min_x + p) <= Float(print.max_x)) & (L::load(max_y + p) >= Float(print.min_y)) &
                  (L::load(min_y + p) <= Float(print.max_y));
    for (const float(&edge)[3] : print.edge) {
      const float* const x = edge[0] >= 0 ? max_x : min_x;
      const float* const y = edge[1] >= 0 ? max_y : min_y;
      inside = inside & (L::mul_add(Float(edge[0]), L::load(x + p), L::mul_add(Float(edge[1]), L::load(y + p), Float(edge[2]))) >= Float(0.0f));
    }
    if constexpr (Stats::kCounting) {
      const std::int32_t left = count - p;
      stats.template count<Event::volume_test, L>(L::less(L::iota(), typename L::Int(left)));
    }
    met |= L::bits(inside) << p;
  }
  return met & ((1u << count) - 1);
}

/// Depth for each unit of the packet's t; not negative, so that dead lanes stay behind everything.
template <class L>
inline typename L::Float depth_along(const ZbufferView& frame, const RayPacket<L>& ray) noexcept {
  using Float = typename L::Float;
  const Float depth = L::mul_add(ray.dir[2], Float(frame.view_dir[2]), L::mul_add(ray.dir[1], Float(frame.view_dir[1]), ray.dir[0] * Float(frame.view_dir[0])));
  return L::max(depth, Float(0.0f));
}

/// Depth of each lane's hit, infinite where there is none, -inf (or NaN) where the lane is dead.
template <class L, int kGroups>
struct HitDepths {
  typename L::Float per_t[Packet<L, kGroups>::kCapacity];

  HitDepths(const ZbufferView& frame, const Packet<L, kGroups>& packet) noexcept {
    for (int g = 0; g < packet.group_count(); ++g) per_t[g] = depth_along<L>(frame, packet.ray[g]);
  }
  /// Whether some lane can still meet what has 1 / depth of `nearest` at the most; and which lanes.
  bool reach(const Packet<L, kGroups>& packet, float nearest, typename L::Mask* lanes) const noexcept {
    bool any = false;
    for (int g = 0; g < packet.group_count(); ++g) {
      lanes[g] = ~(packet.hit[g].t * per_t[g] * typename L::Float(nearest) < typename L::Float(1.0f));  // NaN, from 0 and infinity, reaches
      any = any || L::any(lanes[g]);
    }
    return any;
  }
};

/// The rectangle of one packet.
struct PacketRect {
  float min_x, max_x, min_y, max_y;

  PacketRect(const CellArgs& cell, std::int32_t p) noexcept : min_x(cell.rect[0][p]), max_x(cell.rect[1][p]), min_y(cell.rect[2][p]), max_y(cell.rect[3][p]) {}
  /// The greatest 1 / depth of a plane in the rectangle.
  [[nodiscard]] float nearest(const DepthPlane& plane) const noexcept {
    return plane.per_x * (plane.per_x >= 0 ? max_x : min_x) + (plane.per_y * (plane.per_y >= 0 ? max_y : min_y) + plane.at_center);
  }
};

/// What a packet waits for, nearest first.
struct Waiting {
  std::int32_t count = 0;
  float nearest[kChunk];  ///< of the primitive, where the packet can see it
  std::int32_t prim[kChunk];

  /// Sorts by insertion: candidates come nearly in order.
  void insert(std::int32_t candidate, float inverse_depth) noexcept {
    std::int32_t k = count++;
    for (; k > 0 && nearest[k - 1] < inverse_depth; --k) {
      nearest[k] = nearest[k - 1];
      prim[k] = prim[k - 1];
    }
    nearest[k] = inverse_depth;
    prim[k] = candidate;
  }
};

}  // namespace raymeter
