#pragma once

#include <cstdint>
#include <optional>

#include "core/base/column.h"
#include "core/ray/expected_hits.h"
#include "core/ray/ray_batch.h"
#include "experiments/verify/oracle.h"

namespace raymeter {

/// What is true of a batch. The errors of t are in ulps of the exact t, over the checked hits for which it is known; 0 where there are none.
struct Accuracy {
  std::int64_t rays_checked = 0;
  std::int64_t false_miss = 0;
  std::int64_t false_hit = 0;
  std::int64_t wrong_prim = 0;
  std::optional<std::int64_t> self_hits;  ///< hits of the flat primitive that a ray leaves, of all rays; empty where it is not known which those are
  std::int64_t excused = 0;               ///< of the wrong answers, those of rays whose declared errors allow them (ExpectedHits::excused)
  std::int64_t excused_self_hits = 0;     ///< likewise
  double t_ulp_p50 = 0;
  double t_ulp_p99 = 0;
  double t_ulp_max = 0;

  [[nodiscard]] std::int64_t mismatches() const noexcept { return false_miss + false_hit + wrong_prim; }
  /// Whether, but for excused rays, the share of mismatches is at most `hit_mismatch_max` and none hits what it leaves.
  [[nodiscard]] bool ok(double hit_mismatch_max) const noexcept;
};

/// How much to ask the oracle.
struct OracleBudget {
  double max_tests = 1e9;  ///< rays x primitives; beyond, a sample without repetition that keeps to it (one ray at least)
  std::uint64_t seed = 0;  ///< what alone the sample depends on
  int threads = 0;         ///< at most; 0: all. The result does not depend on their number
};

/// What is expected of a ray says of an answer: `prim`, or a miss where that is negative. Of blockers (not `closest`) any may be named.
[[nodiscard]] Verdict expected_verdict(std::int32_t expected, std::int32_t prim, bool closest) noexcept;

/// Holds all rays against what is expected of them, and against the oracle those that the budget allows. `rays_checked` are those that either has judged.
[[nodiscard]] Accuracy verify_closest(const Oracle& oracle, const RayBatch& rays, const HitBatch& hits, const OracleBudget& budget,
                                      const ExpectedHits& expected = {});
[[nodiscard]] Accuracy verify_any(const Oracle& oracle, const RayBatch& rays, const Column<std::int32_t>& blocker, const OracleBudget& budget,
                                  const ExpectedHits& expected = {});

}  // namespace raymeter
