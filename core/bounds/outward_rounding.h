#pragma once

#include <cmath>
#include <limits>

namespace raymeter {

/// The largest float not above x.
[[nodiscard]] inline float round_down(double x) noexcept {
  const auto f = static_cast<float>(x);
  return static_cast<double>(f) <= x ? f : std::nextafterf(f, -std::numeric_limits<float>::infinity());
}

/// The smallest float not below x.
[[nodiscard]] inline float round_up(double x) noexcept {
  const auto f = static_cast<float>(x);
  return static_cast<double>(f) >= x ? f : std::nextafterf(f, std::numeric_limits<float>::infinity());
}

}  // namespace raymeter
