#pragma once

#include <cstdint>

#include "core/bounds/volume_layout.h"
#include "core/ray/views.h"
#include "core/scene/pools_view.h"
#include "core/simd/isa_enum.h"

namespace raymeter {

/// What rays are tested against: `count` primitives of the kind in question, by position in their pool, or bounding volumes, each of `volume_floats` numbers.
struct MicroTargets {
  PoolsView pools;
  const float* volumes;
  std::int32_t volume_floats;
  KdopLayout::Shared slabs;
  std::int32_t count;
};

/// Sums over all tests; they also keep the compiler from dropping tests whose results nobody wants.
struct MicroSums {
  float hits;
  float t;
};

/// Tests every ray against every target, one register of rays at a time, each test on its own: no hit shortens a ray.
template <Isa I>
struct MicroKernel {
  static MicroSums spheres(const MicroTargets& targets, const RayView& rays) noexcept;
  static MicroSums triangles(const MicroTargets& targets, const RayView& rays) noexcept;
  static MicroSums polygons(const MicroTargets& targets, const RayView& rays) noexcept;
  static MicroSums cones(const MicroTargets& targets, const RayView& rays) noexcept;
  static MicroSums bounding_boxes(const MicroTargets& targets, const RayView& rays) noexcept;
  static MicroSums bounding_spheres(const MicroTargets& targets, const RayView& rays) noexcept;
  static MicroSums oriented_boxes(const MicroTargets& targets, const RayView& rays) noexcept;
  static MicroSums bounding_slabs(const MicroTargets& targets, const RayView& rays) noexcept;
};

}  // namespace raymeter
