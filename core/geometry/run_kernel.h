#pragma once

// Tests a run of primitives of one kind: the only loop over primitives in the project. Every technique's leaves end here, so that all run the same code.

#include "core/geometry/cone_kernel.h"
#include "core/geometry/polygon_kernel.h"
#include "core/geometry/primitive_run.h"
#include "core/geometry/selection.h"
#include "core/geometry/sphere_kernel.h"
#include "core/geometry/triangle_kernel.h"
#include "core/ray/packet_loop.h"

namespace raymeter {

/// A run's primitives by position in the pools.
struct PositionRefs {
  static constexpr Selection kSelection = Selection::none;
  std::int32_t first;
  [[nodiscard]] std::int32_t index(std::int32_t k) const noexcept { return first + k; }
};

/// A run's primitives through a list of positions.
struct ListedRefs {
  static constexpr Selection kSelection = Selection::none;
  const std::int32_t* list;
  [[nodiscard]] std::int32_t index(std::int32_t k) const noexcept { return list[k]; }
};

/// Tests `count` primitives of one kind against every group of the packet that has a lane in `lanes`.
/// refs.index(k) gives the pool index of the k-th, test(ray, hit, i) the candidate, prim the pool's ids. Refs with a kSelection also say which of the lanes
/// want the k-th: refs.wanted(lanes, group, k); the others cannot be improved by it. kExpectHits: most of the primitives are hit by some lane, so that asking
/// whether costs more than it saves.
template <Query Q, bool kExpectHits, class L, int kGroups, class Refs, class Stats, class Test>
inline void test_primitives(Packet<L, kGroups>& packet, const typename L::Mask* lanes, std::int32_t count, const std::int32_t* prim, Refs refs, Stats stats,
                            Test test) noexcept {
  for (int g = 0; g < packet.group_count(); ++g) {
    if (kGroups != 1 && L::none(lanes[g])) continue;
    const RayPacket<L>& ray = packet.ray[g];
    HitPacket<L>& hit = packet.hit[g];
    for (std::int32_t k = 0; k < count; ++k) {
      typename L::Mask tested = lanes[g];
      if constexpr (Refs::kSelection == Selection::tested) {
        tested = refs.wanted(tested, g, k);
        if (L::none(tested)) continue;
      }
      if constexpr (Stats::kCounting) {
        typename L::Mask counted = tested & packet.live(g);
        if (L::none(counted)) continue;  // the timed kernel tests on, to no effect
        if constexpr (Refs::kSelection == Selection::counted) counted = refs.wanted(counted, g, k);
        stats.template count<Event::prim_test, L>(counted);
      }
      const std::int32_t i = refs.index(k);
      const SurfaceHit<L> found = test(ray, hit, i);
      if (!kExpectHits && L::none(found.meets)) continue;
      // Only lanes that are tested: what the others would find depends on how the counting kernel skips.
      const auto closer = tested & improves(ray, hit, found, prim[i]);
      if ((!kExpectHits || Stats::kCounting) && L::none(closer)) continue;
      stats.template count<Event::prim_hit, L>(closer);
      update<Q>(hit, closer, found, prim[i]);
    }
  }
}

/// Tests `count` primitives of one kind that refs (see test_primitives) give.
template <Query Q, class L, int kGroups, class Refs, class Stats>
inline void test_refs(Packet<L, kGroups>& packet, const typename L::Mask* lanes, const PoolsView& pools, PrimKind kind, std::int32_t count, Refs refs,
                      Stats stats) noexcept {
  using Ray = const RayPacket<L>&;
  using Hit = const HitPacket<L>&;
  const auto test_all = [&](const std::int32_t* prim, auto test) noexcept { test_primitives<Q, false>(packet, lanes, count, prim, refs, stats, test); };
  switch (kind) {
    case PrimKind::triangle:
      test_all(pools.triangles.prim, [&](Ray ray, Hit, std::int32_t i) noexcept { return intersect_triangle(ray, pools.triangles, i); });
      break;
    case PrimKind::sphere:
      test_all(
          pools.spheres.prim, [&](Ray ray, Hit, std::int32_t i) __attribute__((always_inline)) { return intersect_sphere(ray, pools.spheres, i); });
      break;
    case PrimKind::polygon:
      test_all(pools.polygons.prim, [&](Ray ray, Hit hit, std::int32_t i) noexcept { return intersect_polygon(ray, hit, pools.polygons, i); });
      break;
    case PrimKind::cone: test_all(pools.cones.prim, [&](Ray ray, Hit hit, std::int32_t i) noexcept { return intersect_cone(ray, hit, pools.cones, i); }); break;
  }
}

/// Tests the primitives of `run`, by position (refs null) or through refs.
template <Query Q, class L, int kGroups, class Stats>
inline void test_run(Packet<L, kGroups>& packet, const typename L::Mask* lanes, const PoolsView& pools, PrimitiveRun run, const std::int32_t* refs,
                     Stats stats) noexcept {
  if (refs != nullptr)
    test_refs<Q, L, kGroups>(packet, lanes, pools, run.kind(), run.count(), ListedRefs{refs + run.first}, stats);
  else
    test_refs<Q, L, kGroups>(packet, lanes, pools, run.kind(), run.count(), PositionRefs{run.first}, stats);
}

}  // namespace raymeter
