#pragma once

#include <memory>
#include <string_view>

#include "accel/technique.h"
#include "core/base/column.h"
#include "core/ray/ray_batch.h"
#include "core/render/first_hit.h"
#include "core/scene/scene.h"
#include "core/simd/isa.h"

namespace raymeter::test {

/// All pixels of an image, in PixelOrder.
[[nodiscard]] Column<std::int32_t> pixels_of(const CameraModel& model);

/// A built structure and a first hit over it.
struct Slots {
  std::unique_ptr<Structure> structure;
  std::unique_ptr<Intersector> intersector;
  std::unique_ptr<FirstHit> first_hit;

  Slots(const Scene& scene, std::string_view technique, Isa isa, int packet);
  /// The hits of eye rays, by the timed and the counting kernels, which have to agree.
  HitBatch find(const CameraModel& model, const Column<std::int32_t>& pixels, int threads = 1, Counters* counters = nullptr);
};

/// A camera that looks along no axis.
[[nodiscard]] CameraModel slanted_model(CameraConvention convention);

/// What is smaller than a sample of the model's image, on and beside it, slivers between samples, edges, vertices and silhouettes through samples, and what
/// lies behind one another at a millionth.
[[nodiscard]] Scene subsample_scene(const CameraModel& model);

}  // namespace raymeter::test
