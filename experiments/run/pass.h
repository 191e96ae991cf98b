#pragma once

#include <cstdint>

#include "core/ray/generators.h"
#include "core/render/first_hit.h"
#include "core/render/occlusion.h"
#include "core/trace/intersector.h"

namespace raymeter {

/// What a pass over a ray set found: nearest hits, or blockers of any-hit rays.
struct Answers {
  Query query = Query::closest;
  HitBatch hits;
  Column<std::int32_t> blocker;

  /// Over the bits of all hits, or over which rays are blocked: equal for all techniques on one instruction set.
  [[nodiscard]] std::uint64_t hash() const noexcept;
};

/// Rays whose answers differ in any bit, or where only one is blocked.
[[nodiscard]] std::int64_t count_differences(const Answers& a, const Answers& b) noexcept;

struct PassTime {
  double prepare_ms = 0;
  double trace_ms = 0;  ///< prepare included
  double cpu_ms = 0;
};

/// What answers a set's rays: the intersector, unless a slot's technique stands before it.
struct Tracers {
  Intersector& intersector;
  FirstHit* first_hit = nullptr;   ///< for sets of eye rays
  Occlusion* occlusion = nullptr;  ///< for sets of shadow rays
};

/// Traces the whole set once. Counters null: the timed kernels.
PassTime run_pass(const Tracers& tracers, const RaySet& rays, int threads, Answers& answers, Counters* counters = nullptr);

/// Up to `blocks` runs of kMaxPacket consecutive rays, spread evenly over the set: packets are as coherent as in the whole.
[[nodiscard]] RaySet sample_of(const RaySet& set, std::size_t blocks);

/// About how long a pass would take on one thread, from a sample of its rays. The first time on a large structure is too long, since it is not in any cache
/// yet.
[[nodiscard]] double estimate_pass_s(Intersector& intersector, const RaySet& set);

}  // namespace raymeter
