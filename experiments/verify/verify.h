#pragma once

#include <cstdint>

#include "core/base/column.h"
#include "core/ray/ray_batch.h"
#include "experiments/verify/oracle.h"

namespace raymeter {

/// What the oracle says of a batch. The errors of t are in ulps of the exact t, over the checked hits for which it is known; 0 where there are none.
struct Accuracy {
  std::int64_t rays_checked = 0;
  std::int64_t false_miss = 0;
  std::int64_t false_hit = 0;
  std::int64_t wrong_prim = 0;
  double t_ulp_p50 = 0;
  double t_ulp_p99 = 0;
  double t_ulp_max = 0;

  [[nodiscard]] std::int64_t mismatches() const noexcept { return false_miss + false_hit + wrong_prim; }
  /// Whether the share of mismatches is at most `hit_mismatch_max`.
  [[nodiscard]] bool ok(double hit_mismatch_max) const noexcept;
};

/// Checks all rays, or where rays x primitives exceeds max_tests a sample without repetition that keeps to it (one ray at least) and depends on `seed` alone.
/// On at most `threads` threads (0: all); the result does not depend on their number.
[[nodiscard]] Accuracy verify_closest(const Oracle& oracle, const RayBatch& rays, const HitBatch& hits, double max_tests, std::uint64_t seed, int threads);
[[nodiscard]] Accuracy verify_any(const Oracle& oracle, const RayBatch& rays, const Column<std::int32_t>& blocker, double max_tests, std::uint64_t seed,
                                  int threads);

}  // namespace raymeter
