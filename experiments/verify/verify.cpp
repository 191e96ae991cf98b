#include "experiments/verify/verify.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <tbb/parallel_for.h>

#include "core/base/random.h"
#include "core/base/threads.h"

namespace raymeter {

namespace {

/// Indices to check, ascending; Knuth's selection sampling.
std::vector<std::size_t> sampled(std::size_t rays, std::size_t prims, double max_tests, std::uint64_t seed) {
  const double affordable = std::floor(max_tests / static_cast<double>(std::max<std::size_t>(prims, 1)));
  const std::size_t wanted = affordable >= static_cast<double>(rays) ? rays : std::max<std::size_t>(1, static_cast<std::size_t>(std::max(affordable, 0.0)));
  RandomStream random(seed, 0);
  std::vector<std::size_t> indices;
  indices.reserve(wanted);
  for (std::size_t i = 0; i < rays && indices.size() < wanted; ++i) {
    const double share = static_cast<double>(wanted - indices.size()) / static_cast<double>(rays - i);
    if (share >= 1 || random.uniform() < share) indices.push_back(i);
  }
  return indices;
}

double percentile(std::vector<double>& values, double share) {
  const auto rank = static_cast<std::ptrdiff_t>(std::ceil(share * static_cast<double>(values.size()))) - 1;
  const auto at = values.begin() + std::max<std::ptrdiff_t>(rank, 0);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

template <class CheckRay>
Accuracy verify_rays(const Oracle& oracle, std::size_t rays, double max_tests, std::uint64_t seed, int threads, CheckRay&& check_ray) {
  const std::vector<std::size_t> indices = sampled(rays, oracle.prim_count(), max_tests, seed);
  std::vector<Check> checks(indices.size());
  on_threads(threads, [&] { tbb::parallel_for(std::size_t{0}, indices.size(), [&](std::size_t k) { checks[k] = check_ray(indices[k]); }); });

  Accuracy accuracy;
  accuracy.rays_checked = static_cast<std::int64_t>(indices.size());
  std::vector<double> errors;
  for (const Check& check : checks) {
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

bool Accuracy::ok(double hit_mismatch_max) const noexcept { return static_cast<double>(mismatches()) <= hit_mismatch_max * static_cast<double>(rays_checked); }

Accuracy verify_closest(const Oracle& oracle, const RayBatch& rays, const HitBatch& hits, double max_tests, std::uint64_t seed, int threads) {
  return verify_rays(oracle, rays.size(), max_tests, seed, threads, [&](std::size_t i) { return oracle.closest(rays[i], hits.t[i], hits.prim[i]); });
}

Accuracy verify_any(const Oracle& oracle, const RayBatch& rays, const Column<std::int32_t>& blocker, double max_tests, std::uint64_t seed, int threads) {
  return verify_rays(oracle, rays.size(), max_tests, seed, threads, [&](std::size_t i) { return oracle.any(rays[i], blocker[i]); });
}

}  // namespace raymeter
