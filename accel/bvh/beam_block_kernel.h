#pragma once

// A packet's rays against a block of triangles.

#include "accel/bvh/beam_node_kernel.h"
#include "core/geometry/triangle_kernel.h"
#include "core/ray/packet_loop.h"
#include "core/stats/policy.h"

namespace raymeter {

/// Tests the triangles given as bits against the registers of rays of which `lanes`, one mask each, names some. Hits stay in registers meanwhile: what one
/// triangle gives, the next one asks for.
template <Query Q, class L, int kGroups, class Stats>
inline void test_triangles(const TriangleBlock& block, std::uint32_t triangles, Packet<L, kGroups>& packet, const typename L::Mask* lanes,
                           Stats stats) noexcept {
  constexpr bool kExpectHits = L::kWidth >= kBeamRays;  // of a whole beam some ray meets most triangles; asking first costs more than it saves
  const float* const column[3] = {block.vertex[0], block.vertex[1], block.vertex[2]};
  for (int g = 0; g < packet.group_count(); ++g) {
    if (L::none(lanes[g])) continue;
    const RayPacket<L>& ray = packet.ray[g];
    HitPacket<L> hit = packet.hit[g];
    for (std::uint32_t left = triangles; left != 0; left &= left - 1) {
      const int t = __builtin_ctz(left);
      if constexpr (Stats::kCounting) {
        const auto live = hit.t > typename L::Float(-kInfinity);
        if (L::none(live)) break;  // the timed kernel tests on, to no effect
        // A split triangle reaches beyond its leaf's box: rays beside the box are tested, but did not ask.
        const auto asking = lanes[g] & live;
        if (!L::none(asking)) stats.template count<Event::prim_test, L>(asking);
      }
      const SurfaceHit<L> found = intersect_triangle<L, kExpectHits>(shear(ray, column, block.corner[0][t]), shear(ray, column, block.corner[1][t]),
                                                                     shear(ray, column, block.corner[2][t]));
      if (!kExpectHits && L::none(found.meets)) continue;
      const auto closer = improves(ray, hit, found, block.prim[t]);
      if constexpr (Stats::kCounting) {
        if (L::any(closer)) stats.template count<Event::prim_hit, L>(closer);
      }
      update<Q>(hit, closer, found, block.prim[t]);
    }
    packet.hit[g] = hit;
  }
}

}  // namespace raymeter
