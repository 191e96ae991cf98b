#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "core/ray/views.h"
#include "core/stats/counters.h"

namespace raymeter {

/// Stands for a blocker that a peer does not name.
inline constexpr std::int32_t kUnknownBlocker = 0x7FFFFFFF;

/// Answers ray queries on one built structure, for one instruction set and packet size. The only virtual seam of the tracer: one call per slice of a batch.
/// Calls on different slices may run at the same time; no state may depend on which thread runs which.
class Intersector {
public:
  virtual ~Intersector() = default;
  /// Sees the whole batch, and what will be asked of it, before it is sliced; may work on `threads` threads (0: all), its time is a phase of its own. What it
  /// does may change how fast later calls are and what they count, the same on any number of threads, but no answer.
  virtual void prepare(const RayView&, Query, int /*threads*/) {}
  /// Whether prepare() keeps something of the batch that the calls on its slices use. Otherwise several batches may be traced at the same time.
  [[nodiscard]] virtual bool keeps_batch() const noexcept { return false; }
  /// The order in which the prepared batch is to be traced: a permutation of its rays; null: as they come. Where there is one, the slice of `count` rays from
  /// `first` on, views of the columns that were prepared, stands for the rays order()[first] .. order()[first + count - 1]: a call answers those, each in its
  /// own place of the batch, so that packets may gather rays from anywhere. All is answered when all slices have been called.
  [[nodiscard]] virtual const std::int32_t* order() const noexcept { return nullptr; }
  /// What calls so far settled on for such a query by looking at the rays, as "key=value,..."; empty where there was nothing to settle.
  [[nodiscard]] virtual std::string choice(Query) const { return {}; }
  /// The one that a call on such a slice is handed to: this one, unless it chooses between several. For looking at what single rays of a slice cost.
  [[nodiscard]] virtual const Intersector& suited(const RayView&, Query) const noexcept { return *this; }
  /// Scratch space that a slice needs, in bytes. It holds what other slices, of other structures too, have left there.
  [[nodiscard]] virtual std::size_t scratch_bytes() const noexcept { return 0; }
  /// Nearest hit of each ray, ties to the smallest primitive id. Counters null: the timed kernel; given: the counting one. `scratch` is 64-byte aligned.
  virtual void closest_hit(const RayView& rays, const HitView& hits, Counters* counters, std::byte* scratch) const noexcept = 0;
  /// blocker[i]: some primitive that blocks ray i, -1 where it is free.
  virtual void any_hit(const RayView& rays, std::int32_t* blocker, Counters* counters, std::byte* scratch) const noexcept = 0;
};

}  // namespace raymeter
