// The primitive tests alone, without traversal: what micro-benchmarks time.

#include "experiments/micro/micro_kernel.h"

#include "core/bounds/slab_kernel.h"
#include "core/geometry/cone_kernel.h"
#include "core/geometry/polygon_kernel.h"
#include "core/geometry/sphere_kernel.h"
#include "core/geometry/triangle_kernel.h"
#include "core/ray/packet_loop.h"

namespace raymeter {

namespace {

/// Calls test(ray, hit, i) for every register of rays and target i.
template <class L, class Test>
MicroSums test_all(const MicroTargets& targets, const RayView& rays, Test test) noexcept {
  using Float = typename L::Float;
  Float hits(0.0f), t_sum(0.0f);
  for (std::int32_t first = 0; first < rays.count; first += L::kWidth) {
    const std::int32_t left = rays.count - first;
    RayPacket<L> ray;
    HitPacket<L> hit;
    load_group<L>(rays, first, left < L::kWidth ? left : L::kWidth, ray, hit);
    const auto live = hit.t > Float(-kInfinity);
    for (std::int32_t i = 0; i < targets.count; ++i) {
      const SurfaceHit<L> found = test(ray, hit, i);
      const auto meets = found.meets & live;
      if (L::none(meets)) continue;
      hits = L::select(meets, hits + Float(1.0f), hits);
      t_sum = L::select(meets, t_sum + found.t, t_sum);
    }
  }
  float hit_lane[L::kWidth], t_lane[L::kWidth];
  L::store(hit_lane, hits);
  L::store(t_lane, t_sum);
  MicroSums sums{};
  for (int lane = 0; lane < L::kWidth; ++lane) {
    sums.hits += hit_lane[lane];
    sums.t += t_lane[lane];
  }
  return sums;
}

}  // namespace

template <Isa I>
MicroSums MicroKernel<I>::spheres(const MicroTargets& targets, const RayView& rays) noexcept {
  using L = Lanes<I>;
  return test_all<L>(targets, rays, [&](const RayPacket<L>& ray, const HitPacket<L>&, std::int32_t i) noexcept {
    return intersect_sphere(ray, targets.pools.spheres, i);
  });
}

template <Isa I>
MicroSums MicroKernel<I>::triangles(const MicroTargets& targets, const RayView& rays) noexcept {
  using L = Lanes<I>;
  return test_all<L>(targets, rays, [&](const RayPacket<L>& ray, const HitPacket<L>&, std::int32_t i) noexcept {
    return intersect_triangle(ray, targets.pools.triangles, i);
  });
}

template <Isa I>
MicroSums MicroKernel<I>::polygons(const MicroTargets& targets, const RayView& rays) noexcept {
  using L = Lanes<I>;
  return test_all<L>(targets, rays, [&](const RayPacket<L>& ray, const HitPacket<L>& hit, std::int32_t i) noexcept {
    return intersect_polygon(ray, hit, targets.pools.polygons, i);
  });
}

template <Isa I>
MicroSums MicroKernel<I>::cones(const MicroTargets& targets, const RayView& rays) noexcept {
  using L = Lanes<I>;
  return test_all<L>(targets, rays, [&](const RayPacket<L>& ray, const HitPacket<L>& hit, std::int32_t i) noexcept {
    return intersect_cone(ray, hit, targets.pools.cones, i);
  });
}

template <Isa I>
MicroSums MicroKernel<I>::boxes(const MicroTargets& targets, const RayView& rays) noexcept {
  using L = Lanes<I>;
  return test_all<L>(targets, rays, [&](const RayPacket<L>& ray, const HitPacket<L>& hit, std::int32_t i) noexcept {
    const float* box = targets.boxes + 6 * i;
    const SlabInterval<L> inside = ray.octant >= 0
                                       ? intersect_box(ray, hit.t, BoxPlanes<L, true>(box, ray.octant))
                                       : intersect_box(ray, hit.t, BoxPlanes<L, false>(box, 0));
    return SurfaceHit<L>{inside.t_near <= inside.t_far, inside.t_near, inside.t_near, inside.t_far};
  });
}

template struct MicroKernel<kKernelIsa>;

}  // namespace raymeter
