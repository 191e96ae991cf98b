// The primitive tests alone, without traversal: what micro-benchmarks time.

#include "experiments/micro/micro_kernel.h"

#include "core/bounds/aabb_kernel.h"
#include "core/bounds/kdop_kernel.h"
#include "core/bounds/obb_kernel.h"
#include "core/bounds/sphere_volume_kernel.h"
#include "core/geometry/cone_kernel.h"
#include "core/geometry/polygon_kernel.h"
#include "core/geometry/sphere_kernel.h"
#include "core/geometry/triangle_kernel.h"
#include "core/ray/packet_loop.h"

namespace raymeter {

namespace {

/// Calls prepare(ray) for every register of rays, and test(ray, hit, i) for each and every target i.
template <class L, class Prepare, class Test>
MicroSums test_all(const MicroTargets& targets, const RayView& rays, Prepare prepare, Test test) noexcept {
  using Float = typename L::Float;
  Float hits(0.0f), t_sum(0.0f);
  for (std::int32_t first = 0; first < rays.count; first += L::kWidth) {
    const std::int32_t left = rays.count - first;
    RayPacket<L> ray;
    HitPacket<L> hit;
    load_group<L>(rays, first, left < L::kWidth ? left : L::kWidth, ray, hit);
    prepare(ray);
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

template <class L, class Test>
MicroSums test_all(const MicroTargets& targets, const RayView& rays, Test test) noexcept {
  return test_all<L>(
      targets, rays, [](const RayPacket<L>&) noexcept {}, test);
}

}  // namespace

template <Isa I>
MicroSums MicroKernel<I>::spheres(const MicroTargets& targets, const RayView& rays) noexcept {
  using L = Lanes<I>;
  return test_all<L>(
      targets, rays, [&](const RayPacket<L>& ray, const HitPacket<L>&, std::int32_t i) __attribute__((always_inline)) {
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

namespace {

template <class L, class Layout>
MicroSums test_volumes(const MicroTargets& targets, const RayView& rays, const typename Layout::Shared& shared) noexcept {
  VolumeRays<Layout, L> set_up;
  return test_all<L>(
      targets, rays, [&](const RayPacket<L>& ray) noexcept { set_up.prepare(shared, ray); },
      [&](const RayPacket<L>& ray, const HitPacket<L>& hit, std::int32_t i) noexcept {
        const float* const data = targets.volumes + i * targets.volume_floats;
        const SlabInterval<L> inside = VolumeRays<Layout, L>::kSigned && ray.octant >= 0
                                           ? intersect_volume(ray, set_up, hit.t, VolumeTest<Layout, L, true>(shared, data, ray.octant))
                                           : intersect_volume(ray, set_up, hit.t, VolumeTest<Layout, L, false>(shared, data, 0));
        return SurfaceHit<L>{inside.t_near <= inside.t_far, inside.t_near, inside.t_near, inside.t_far};
      });
}

}  // namespace

template <Isa I>
MicroSums MicroKernel<I>::bounding_boxes(const MicroTargets& targets, const RayView& rays) noexcept {
  float reach = 0;
  for (std::int32_t i = 0; i < targets.count * AabbLayout::kFloats; ++i) {
    const float size = __builtin_fabsf(targets.volumes[i]);
    if (size > reach && size <= kLargest) reach = size;
  }
  return test_volumes<Lanes<I>, AabbLayout>(targets, rays, {reach});
}

template <Isa I>
MicroSums MicroKernel<I>::bounding_spheres(const MicroTargets& targets, const RayView& rays) noexcept {
  return test_volumes<Lanes<I>, SphereLayout>(targets, rays, {});
}

template <Isa I>
MicroSums MicroKernel<I>::oriented_boxes(const MicroTargets& targets, const RayView& rays) noexcept {
  return test_volumes<Lanes<I>, ObbLayout>(targets, rays, {});
}

template <Isa I>
MicroSums MicroKernel<I>::bounding_slabs(const MicroTargets& targets, const RayView& rays) noexcept {
  return test_volumes<Lanes<I>, KdopLayout>(targets, rays, targets.slabs);
}

template struct MicroKernel<kKernelIsa>;

}  // namespace raymeter
