#pragma once

// One ray against the spheres of a leaf, spheres in lanes, by the test of core/geometry/sphere_kernel.h.

#include "accel/bvh/stream_hit_kernel.h"
#include "accel/bvh/stream_layout.h"
#include "core/geometry/primitive_run.h"
#include "core/geometry/sphere_kernel.h"

namespace raymeter {

/// One ray in all lanes, as far as spheres ask for it.
template <class L>
[[gnu::always_inline]] inline RayPacket<L> in_all_lanes(const StreamRay& ray, const StreamLine& line, std::uint32_t octant) noexcept {
  using Float = typename L::Float;
  RayPacket<L> one;
  for (int a = 0; a < 3; ++a) {
    one.org[a] = Float(ray.org[a]);
    one.dir[a] = Float(line.dir[a]);
    one.inv_dir[a] = Float(line.inv_dir[a]);
    one.negative[a] = L::mask(0u - (octant >> a & 1));
  }
  one.inv_length2 = Float(line.inv_length2);
  one.t_min = Float(ray.interval[0]);
  return one;
}

/// Calls take(LeafHits) for each register of the run's spheres; `kExpectHits` as for intersect_sphere().
template <class L, bool kExpectHits, class Stats, class Take>
[[gnu::always_inline]] inline void meet_spheres(const StreamRay& ray, const StreamLine& line, std::uint32_t octant, const SphereView& pool, PrimitiveRun run,
                                                Stats stats, Take take) noexcept {
  using Float = typename L::Float;
  const RayPacket<L> one = in_all_lanes<L>(ray, line, octant);
  const Float t_end(-ray.interval[1]);
  for (std::int32_t first = 0; first < run.count(); first += L::kWidth) {
    const std::int32_t left = run.count() - first;
    const std::uint32_t present = (1u << (left < L::kWidth ? left : L::kWidth)) - 1;
    stats.template count<Event::prim_test, L>(L::mask(present));
    const std::int32_t at = run.first + first;
    const Float center[3] = {L::load(pool.center[0] + at), L::load(pool.center[1] + at), L::load(pool.center[2] + at)};
    const SurfaceHit<L> found = intersect_sphere<L, kExpectHits>(one, center, L::load(pool.radius + at));
    take(LeafHits<L>{found, L::bits(found.meets & (found.t >= one.t_min) & (found.t <= t_end)) & present, first});
  }
}

}  // namespace raymeter
