#include "experiments/record/statistics.h"

#include <algorithm>
#include <cmath>

namespace raymeter {

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

std::optional<Interval> median_interval(std::vector<double> values) {
  const std::size_t n = values.size();
  std::sort(values.begin(), values.end());
  // [x(k), x(n+1-k)] misses the median with twice the probability that fewer than k of n fair coins fall heads: take the largest k for which that is at most 5
  // %.
  const auto count = static_cast<double>(n);
  double coins = std::exp2(-count);  // exactly i heads
  double tail = coins;               // at most i heads
  std::size_t k = 0;
  for (std::size_t i = 0; 2 * tail <= 0.05 && i < n / 2; ++i) {
    k = i + 1;
    const auto heads = static_cast<double>(i + 1);
    coins *= (count - heads + 1) / heads;
    tail += coins;
  }
  if (k == 0) return std::nullopt;
  return Interval{values[k - 1], values[n - k]};
}

double median_deviation(std::span<const double> values) {
  const double middle = median({values.begin(), values.end()});
  std::vector<double> deviations;
  for (const double value : values) deviations.push_back(std::abs(value - middle));
  return median(std::move(deviations));
}

double geometric_mean(std::span<const double> values) {
  double sum = 0;
  for (const double value : values) sum += std::log(value);
  return std::exp(sum / static_cast<double>(values.size()));
}

}  // namespace raymeter
