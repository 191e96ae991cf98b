#include "experiments/verify/sample.h"

#include <algorithm>
#include <cmath>

#include "core/base/random.h"

namespace raymeter {

/// Knuth's selection sampling.
std::vector<std::size_t> sampled(std::size_t rays, std::size_t tests_per_ray, double max_tests, std::uint64_t seed) {
  const double affordable = std::floor(max_tests / static_cast<double>(std::max<std::size_t>(tests_per_ray, 1)));
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

}  // namespace raymeter
