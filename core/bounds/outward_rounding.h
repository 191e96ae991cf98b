#pragma once

#include <bit>
#include <cstdint>

namespace raymeter {

// Neither branches: which way a number was rounded no branch can foresee.

namespace outward_rounding {

/// The float next to f, away from zero or, where `away` is -1, towards it; `step` 0: f itself.
[[nodiscard]] inline float stepped(float f, std::int32_t step) noexcept { return std::bit_cast<float>(std::bit_cast<std::int32_t>(f) + step); }
/// 1 for positive numbers, -1 for negative ones: the bits of these count away from zero.
[[nodiscard]] inline std::int32_t upwards(float f) noexcept { return std::bit_cast<std::int32_t>(f) >> 31 | 1; }

}  // namespace outward_rounding

/// The largest float not above x.
[[nodiscard]] inline float round_down(double x) noexcept {
  const auto f = static_cast<float>(x);
  return outward_rounding::stepped(f, static_cast<double>(f) > x ? -outward_rounding::upwards(f) : 0);
}

/// The smallest float not below x.
[[nodiscard]] inline float round_up(double x) noexcept {
  const auto f = static_cast<float>(x);
  return outward_rounding::stepped(f, static_cast<double>(f) < x ? outward_rounding::upwards(f) : 0);
}

}  // namespace raymeter
