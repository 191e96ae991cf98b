#pragma once

#include <bit>
#include <cstdint>

namespace raymeter {

// Neither branches: which way a number was rounded no branch can foresee.

namespace outward_rounding {

/// The bits of a number, and what is to be added for the next larger one: those of negative numbers count away from zero.
[[nodiscard]] inline std::int32_t bits(float f) noexcept { return std::bit_cast<std::int32_t>(f); }
[[nodiscard]] inline std::int32_t upwards(float f) noexcept { return bits(f) >> 31 | 1; }

}  // namespace outward_rounding

/// The largest float not above x.
[[nodiscard]] inline float round_down(double x) noexcept {
  const auto f = static_cast<float>(x);
  const auto too_large = -static_cast<std::int32_t>(static_cast<double>(f) > x);
  return std::bit_cast<float>(outward_rounding::bits(f) - (outward_rounding::upwards(f) & too_large));
}

/// The smallest float not below x.
[[nodiscard]] inline float round_up(double x) noexcept {
  const auto f = static_cast<float>(x);
  const auto too_small = -static_cast<std::int32_t>(static_cast<double>(f) < x);
  return std::bit_cast<float>(outward_rounding::bits(f) + (outward_rounding::upwards(f) & too_small));
}

}  // namespace raymeter
