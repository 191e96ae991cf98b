#pragma once

#include <cstdint>
#include <memory>

#include "core/base/column.h"
#include "core/ray/ray_batch.h"
#include "core/ray/shadow_origins.h"
#include "core/trace/trace.h"

namespace raymeter {

/// Which shadow rays are blocked: the slot for techniques that know more of them than that they are rays. It stands before an intersector, which answers what
/// the technique leaves open, and never changes which rays are blocked.
class Occlusion {
public:
  virtual ~Occlusion() = default;
  /// A frame, a pass or a tile begins: forgets what earlier rays taught, so that counts and times do not depend on them.
  virtual void begin() {}
  /// Whether rays must come in the frame's order: then its tiles are traced one after another, and the frame alone begins it.
  [[nodiscard]] virtual bool needs_order() const noexcept { return false; }
  /// One of its own for a thread that traces tiles of a frame beside other threads: each tile begins it anew. Null where order is needed.
  [[nodiscard]] virtual std::unique_ptr<Occlusion> for_tiles() const = 0;
  /// blocker[i]: some primitive that blocks ray i, -1 where it is free. Batches of a frame, or of a tile, come in a fixed order, whatever the threads.
  virtual void find(const RayBatch& rays, const ShadowOrigins& origins, Column<std::int32_t>& blocker, int threads, Counters* counters) = 0;
};

/// Shadow rays as any other rays.
class TracedOcclusion final : public Occlusion {
public:
  explicit TracedOcclusion(Intersector& intersector) : intersector_(intersector) {}
  [[nodiscard]] std::unique_ptr<Occlusion> for_tiles() const override { return std::make_unique<TracedOcclusion>(intersector_); }
  void find(const RayBatch& rays, const ShadowOrigins&, Column<std::int32_t>& blocker, int threads, Counters* counters) override {
    intersector_.prepare(rays.view(), Query::any, threads);
    trace_any(intersector_, rays, blocker, threads, counters);
  }

private:
  Intersector& intersector_;
};

}  // namespace raymeter
