#pragma once

// Tests a run of primitives of one kind: the only loop over primitives in the project. Every technique's leaves end here, so that all run the same code.

#include "core/geometry/cone_kernel.h"
#include "core/geometry/polygon_kernel.h"
#include "core/geometry/primitive_run.h"
#include "core/geometry/sphere_kernel.h"
#include "core/geometry/triangle_kernel.h"
#include "core/ray/packet_loop.h"

namespace raymeter {

/// Tests `count` primitives of one kind against every group of the packet that has a lane in `lanes`.
/// index(k) gives the pool index of the k-th, test(ray, hit, i) the candidate, prim the pool's ids.
template <Query Q, class L, int kGroups, class Stats, class Index, class Test>
inline void test_primitives(Packet<L, kGroups>& packet, const typename L::Mask* lanes, std::int32_t count, const std::int32_t* prim, Stats stats,
                            Index index, Test test) noexcept {
  for (int g = 0; g < packet.group_count(); ++g) {
    if (kGroups != 1 && L::none(lanes[g])) continue;
    const RayPacket<L>& ray = packet.ray[g];
    HitPacket<L>& hit = packet.hit[g];
    for (std::int32_t k = 0; k < count; ++k) {
      if constexpr (Stats::kCounting) {
        const typename L::Mask tested = lanes[g] & packet.live(g);
        if (L::none(tested)) break;  // the timed kernel tests on, to no effect
        stats.template count<Event::prim_test, L>(tested);
      }
      const std::int32_t i = index(k);
      const SurfaceHit<L> found = test(ray, hit, i);
      if (L::none(found.meets)) continue;
      const auto closer = improves(ray, hit, found, prim[i]);
      if (L::none(closer)) continue;
      stats.template count<Event::prim_hit, L>(closer);
      update<Q>(hit, closer, found, prim[i]);
    }
  }
}

/// Tests the primitives of `run`, by position (refs null) or through refs.
template <Query Q, class L, int kGroups, class Stats>
inline void test_run(Packet<L, kGroups>& packet, const typename L::Mask* lanes, const PoolsView& pools, PrimitiveRun run, const std::int32_t* refs,
                     Stats stats) noexcept {
  const std::int32_t first = run.first;
  const auto with_index = [&](const std::int32_t* prim, auto test) noexcept {
    if (refs != nullptr) {
      test_primitives<Q, L, kGroups>(packet, lanes, run.count(), prim, stats, [refs, first](std::int32_t k) noexcept { return refs[first + k]; }, test);
    } else {
      test_primitives<Q, L, kGroups>(packet, lanes, run.count(), prim, stats, [first](std::int32_t k) noexcept { return first + k; }, test);
    }
  };
  using Ray = const RayPacket<L>&;
  using Hit = const HitPacket<L>&;
  switch (run.kind()) {
    case PrimKind::triangle:
      with_index(pools.triangles.prim, [&](Ray ray, Hit, std::int32_t i) noexcept { return intersect_triangle(ray, pools.triangles, i); });
      break;
    case PrimKind::sphere:
      with_index(pools.spheres.prim, [&](Ray ray, Hit hit, std::int32_t i) noexcept { return intersect_sphere(ray, hit, pools.spheres, i); });
      break;
    case PrimKind::polygon:
      with_index(pools.polygons.prim, [&](Ray ray, Hit hit, std::int32_t i) noexcept { return intersect_polygon(ray, hit, pools.polygons, i); });
      break;
    case PrimKind::cone:
      with_index(pools.cones.prim, [&](Ray ray, Hit hit, std::int32_t i) noexcept { return intersect_cone(ray, hit, pools.cones, i); });
      break;
  }
}

}  // namespace raymeter
