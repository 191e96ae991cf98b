#pragma once

// Leaves under weak box tests: triangles and spheres are tested as the view says, in one function for each packet shape, so that variants do not multiply with
// box tests. The choice costs the weak tests a branch a leaf that the robust ones have not.

#include "accel/volume_links_kernel.h"
#include "core/bounds/weak_box_kernel.h"
#include "core/geometry/weak_sphere_kernel.h"
#include "core/geometry/weak_triangle_kernel.h"

namespace raymeter {

template <Query Q, class Shared, class L, int kGroups, class Stats>
[[gnu::noinline]] void test_weakly(Packet<L, kGroups>& packet, const typename L::Mask* lanes, const PoolsView& pools, PrimitiveRun run, const Shared& shared,
                                   Stats stats) noexcept {
  const TriangleTest triangle = shared.triangle;
  const SphereTest sphere = shared.sphere;
  const auto test_all = [&](const std::int32_t* prim, auto test) noexcept {
    test_primitives<Q, false>(packet, lanes, run.count(), prim, PositionRefs{run.first}, stats,
                              [&](const RayPacket<L>& ray, const HitPacket<L>&, std::int32_t i) noexcept { return test(ray, i); });
  };
  const auto triangles = [&](auto test) noexcept {
    test_all(pools.triangles.prim, [&](const RayPacket<L>& ray, std::int32_t i) noexcept { return test(ray, pools.triangles, i); });
  };
  const auto loose = [&](auto test) noexcept {
    triangles([&](const RayPacket<L>& ray, const TriangleView& pool, std::int32_t i) noexcept { return test(ray, pool, i, shared.triangle_epsilon); });
  };
  const auto spheres = [&](auto test) noexcept {
    test_all(pools.spheres.prim, [&](const RayPacket<L>& ray, std::int32_t i) noexcept { return test(ray, pools.spheres, i); });
  };
  if (run.kind() == PrimKind::triangle && triangle != TriangleTest::woop_kahan) {
    switch (triangle) {
      case TriangleTest::woop: return triangles(woop_triangle<L>);
      case TriangleTest::moeller_trumbore: return loose(moeller_trumbore_triangle<false, L>);
      case TriangleTest::moeller_trumbore_epsilon: return loose(moeller_trumbore_triangle<true, L>);
      case TriangleTest::moeller_trumbore_double: return triangles(moeller_trumbore_double_triangle<L>);
      case TriangleTest::baldwin_weber:
        return test_all(pools.triangles.prim,
                        [&](const RayPacket<L>& ray, std::int32_t i) noexcept { return baldwin_weber_triangle<L>(ray, shared.unit_triangles, i); });
      case TriangleTest::pluecker_epsilon: return loose(pluecker_triangle<true, L>);
      default: return loose(pluecker_triangle<false, L>);
    }
  }
  if (run.kind() == PrimKind::sphere && sphere == SphereTest::naive) return spheres(weak_sphere<false, L>);
  if (run.kind() == PrimKind::sphere && sphere == SphereTest::haines) return spheres(weak_sphere<true, L>);
  test_run<Q, L, kGroups>(packet, lanes, pools, run, nullptr, stats);
}

/// The traversal finds this one for weak layouts: it is the more special of the two.
template <Query Q, BoxTest B, class L, int kGroups, class Stats>
inline void visit_leaf(const VolumeLinksView<WeakBoxLayout<B>>& links, Travellers<WeakBoxLayout<B>, L, kGroups>& travellers, const VolumeLink& leaf,
                       Stats stats) noexcept {
  travellers.template count_live<Event::leaf_visit>(stats);
  const auto test = [&](PrimitiveRun run) noexcept { test_weakly<Q>(travellers.packet, travellers.live, links.pools, run, links.shared, stats); };
  if (leaf.tag() != VolumeLink::kRuns) return test(PrimitiveRun{leaf.tag_and_count, leaf.first});
  for (std::int32_t r = leaf.first; r < leaf.first + leaf.count(); ++r) test(links.runs[r]);
}

}  // namespace raymeter
