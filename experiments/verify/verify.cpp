#include "experiments/verify/verify.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include <tbb/parallel_for.h>

#include "core/base/threads.h"
#include "experiments/verify/sample.h"

namespace raymeter {

namespace {

double percentile(std::vector<double>& values, double share) {
  const auto rank = static_cast<std::ptrdiff_t>(std::ceil(share * static_cast<double>(values.size()))) - 1;
  const auto at = values.begin() + std::max<std::ptrdiff_t>(rank, 0);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Where the oracle has not looked, or found no fault, what is expected decides.
std::vector<Check> merged(std::vector<Check> checks, std::span<const std::size_t> asked, const ExpectedHits& expected, const Column<std::int32_t>& prims,
                          const Column<float>* t) {
  if (expected.prim.empty()) return checks;
  std::vector<Check> all(prims.size());
  for (std::size_t k = 0; k < asked.size(); ++k) all[asked[k]] = checks[k];
  for (std::size_t i = 0; i < prims.size(); ++i) {
    const Verdict verdict = expected_verdict(expected.prim[i], prims[i], t != nullptr);
    if (verdict != Verdict::correct) all[i] = {verdict};
    if (t != nullptr && !expected.t.empty() && prims[i] >= 0 && !std::isnan(expected.t[i])) all[i].t_ulp = ulps((*t)[i], expected.t[i]);
  }
  return all;
}

/// Rays that the oracle or what is expected of them has judged.
std::int64_t count_judged(std::span<const std::size_t> asked, const ExpectedHits& expected) {
  auto judged = static_cast<std::int64_t>(asked.size());
  for (const std::int32_t prim : expected.prim) judged += prim != ExpectedHits::kUnknown ? 1 : 0;
  if (!expected.prim.empty()) judged -= std::count_if(asked.begin(), asked.end(), [&](std::size_t i) { return expected.prim[i] != ExpectedHits::kUnknown; });
  return judged;
}

bool is_excused(const ExpectedHits& expected, std::size_t ray) noexcept { return !expected.excused.empty() && expected.excused[ray]; }

void count_self_hits(const ExpectedHits& expected, const Column<std::int32_t>& prims, Accuracy& accuracy) {
  if (expected.source.empty()) return;
  std::int64_t& count = accuracy.self_hits.emplace(0);
  for (std::size_t i = 0; i < expected.source.size(); ++i) {
    if (prims[i] < 0 || prims[i] != expected.source[i]) continue;
    ++count;
    accuracy.excused_self_hits += is_excused(expected, i) ? 1 : 0;
  }
}

/// `t` null: blockers. check_ray(i) asks the oracle.
template <class CheckRay>
Accuracy verify_rays(const Oracle& oracle, const OracleBudget& budget, const ExpectedHits& expected, const Column<std::int32_t>& prims, const Column<float>* t,
                     CheckRay&& check_ray) {
  const std::vector<std::size_t> indices = sampled(prims.size(), oracle.prim_count(), budget.max_tests, budget.seed);
  std::vector<Check> asked(indices.size());
  on_threads(budget.threads, [&] { tbb::parallel_for(std::size_t{0}, indices.size(), [&](std::size_t k) { asked[k] = check_ray(indices[k]); }); });
  const std::vector<Check> checks = merged(std::move(asked), indices, expected, prims, t);

  Accuracy accuracy;
  accuracy.rays_checked = count_judged(indices, expected);
  count_self_hits(expected, prims, accuracy);
  std::vector<double> errors;
  for (std::size_t k = 0; k < checks.size(); ++k) {
    const Check& check = checks[k];
    const std::size_t ray = checks.size() == prims.size() ? k : indices[k];
    accuracy.excused += check.verdict != Verdict::correct && is_excused(expected, ray) ? 1 : 0;
    accuracy.false_miss += check.verdict == Verdict::false_miss;
    accuracy.false_hit += check.verdict == Verdict::false_hit;
    accuracy.wrong_prim += check.verdict == Verdict::wrong_prim;
    if (check.t_ulp >= 0) errors.push_back(check.t_ulp);
  }
  if (!errors.empty()) {
    accuracy.t_ulp_p50 = percentile(errors, 0.5);
    accuracy.t_ulp_p99 = percentile(errors, 0.99);
    accuracy.t_ulp_max = percentile(errors, 1);
  }
  return accuracy;
}

}  // namespace

Verdict expected_verdict(std::int32_t expected, std::int32_t prim, bool closest) noexcept {
  if (expected == ExpectedHits::kUnknown) return Verdict::correct;
  if (prim < 0) return expected == ExpectedHits::kNothing ? Verdict::correct : Verdict::false_miss;
  if (expected == ExpectedHits::kNothing) return Verdict::false_hit;
  return closest && expected >= 0 && expected != prim ? Verdict::wrong_prim : Verdict::correct;
}

bool Accuracy::ok(double hit_mismatch_max) const noexcept {
  const double allowed = hit_mismatch_max * static_cast<double>(rays_checked);
  return static_cast<double>(mismatches() - excused) <= allowed && self_hits.value_or(0) <= excused_self_hits;
}

Accuracy verify_closest(const Oracle& oracle, const RayBatch& rays, const HitBatch& hits, const OracleBudget& budget, const ExpectedHits& expected) {
  return verify_rays(oracle, budget, expected, hits.prim, &hits.t, [&](std::size_t i) { return oracle.closest(rays[i], hits.t[i], hits.prim[i]); });
}

Accuracy verify_any(const Oracle& oracle, const RayBatch& rays, const Column<std::int32_t>& blocker, const OracleBudget& budget, const ExpectedHits& expected) {
  return verify_rays(oracle, budget, expected, blocker, nullptr, [&](std::size_t i) { return oracle.any(rays[i], blocker[i]); });
}

}  // namespace raymeter
