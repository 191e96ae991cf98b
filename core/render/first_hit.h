#pragma once

#include <cstdint>

#include "core/base/column.h"
#include "core/ray/ray_batch.h"
#include "core/scene/camera.h"
#include "core/trace/trace.h"

namespace raymeter {

/// What the eye sees first: the slot for techniques that know more of eye rays than that they are rays.
class FirstHit {
public:
  virtual ~FirstHit() = default;
  /// A frame begins: until the next call, `find` is called for its tiles, with this model, for several at a time unless the intersector keeps its batch.
  virtual void begin(const CameraModel&, int /*threads*/) {}
  /// The nearest hits of the eye rays (core/ray/generators.h) through `pixels`, y * width + x, of the model's image.
  virtual void find(const CameraModel& model, const Column<std::int32_t>& pixels, const RayBatch& eye_rays, HitBatch& hits, int threads,
                    Counters* counters) = 0;
};

/// The first hit as for any other ray.
class CastFirstHit final : public FirstHit {
public:
  explicit CastFirstHit(Intersector& intersector) : intersector_(intersector) {}
  void find(const CameraModel&, const Column<std::int32_t>&, const RayBatch& eye_rays, HitBatch& hits, int threads, Counters* counters) override {
    intersector_.prepare(eye_rays.view(), Query::closest, threads);
    trace_closest(intersector_, eye_rays, hits, threads, counters);
  }

private:
  Intersector& intersector_;
};

}  // namespace raymeter
