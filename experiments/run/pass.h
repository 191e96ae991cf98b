#pragma once

#include <cstdint>

#include "core/ray/generators.h"
#include "core/render/whitted.h"
#include "core/trace/intersector.h"

namespace raymeter {

/// What a pass found: nearest hits or blockers of a ray set, or a whole image.
struct Answers {
  enum class Kind : std::uint8_t { closest, any, image };
  Kind kind = Kind::closest;
  HitBatch hits;
  Column<std::int32_t> blocker;
  Image image;

  /// Over the bits of all hits or pixels, or over which rays are blocked: equal for all techniques on one instruction set.
  [[nodiscard]] std::uint64_t hash() const noexcept;
  /// Of a ray set: rays that hit, or are blocked.
  [[nodiscard]] std::int64_t hit_count() const noexcept;
};

/// Rays or pixels whose answers differ in any bit, or where only one is blocked.
[[nodiscard]] std::int64_t count_differences(const Answers& a, const Answers& b) noexcept;

struct PassTime {
  double prepare_ms = 0;
  double trace_ms = 0;  ///< prepare included
  double cpu_ms = 0;
};

/// What answers rays: the intersector, unless a slot's technique stands before it.
struct Tracers {
  Intersector& intersector;
  FirstHit* first_hit = nullptr;   ///< for eye rays
  Occlusion* occlusion = nullptr;  ///< for shadow rays
};

/// Traces the whole set once. Counters null: the timed kernels.
PassTime run_pass(const Tracers& tracers, const RaySet& rays, int threads, Answers& answers, Counters* counters = nullptr);

/// A complete frame, as image cells trace it.
struct Frame {
  const Scene* scene = nullptr;
  CameraModel model;
  Termination termination;
  bool general = false;  ///< see RenderOptions
  const std::vector<LightTarget>* lights = nullptr;
};

struct FramePass {
  PassTime time;
  RayCounts rays;
  DepthCounts depth;
  FrameTotals totals;
  Column<glm::vec3> bound;  ///< Rendering::bound, where the counting kernels trace
};

/// Renders the frame once. `count`: by the counting kernels.
FramePass run_frame(const Tracers& tracers, const Frame& frame, int threads, Answers& answers, bool count = false);

/// Up to `blocks` runs of kMaxPacket consecutive rays, spread evenly over the set: packets are as coherent as in the whole.
[[nodiscard]] RaySet sample_of(const RaySet& set, std::size_t blocks);

/// About how long a pass would take on one thread, from a sample of its rays. The first time on a large structure is too long, since it is not in any cache
/// yet.
[[nodiscard]] double estimate_pass_s(Intersector& intersector, const RaySet& set);
/// The same for a frame, from one with fewer pixels.
[[nodiscard]] double estimate_frame_s(const Tracers& tracers, const Frame& frame);

}  // namespace raymeter
