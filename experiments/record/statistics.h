#pragma once

#include <optional>
#include <span>
#include <vector>

namespace raymeter {

/// An interval that covers the median with at least 95 %.
struct Interval {
  double lo = 0;
  double hi = 0;
};

/// Median of at least one value.
[[nodiscard]] double median(std::vector<double> values);
/// Distribution-free: from the order statistics at which a sign test of the median would reject (Thompson 1936). Empty below 6 values, where none covers 95 %.
[[nodiscard]] std::optional<Interval> median_interval(std::vector<double> values);
/// Median absolute deviation from the median, unscaled, of at least one value.
[[nodiscard]] double median_deviation(std::span<const double> values);
/// Geometric mean of positive values, at least one.
[[nodiscard]] double geometric_mean(std::span<const double> values);

}  // namespace raymeter
