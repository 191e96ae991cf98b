#pragma once

#include <cstdint>

namespace raymeter {

/// Random numbers by counting: a stream is named by a seed and a key, so that a ray's numbers depend on neither threads nor other rays.
/// SplitMix64 (Steele, Lea, Flood 2014, OOPSLA), its starting state hashed from seed and key.
class RandomStream {
public:
  RandomStream(std::uint64_t seed, std::uint64_t key) noexcept : state_(mix(seed + kStep) ^ mix(key * kStep + seed)) {}

  std::uint64_t bits() noexcept { return mix(state_ += kStep); }
  /// Uniform in [0, 1), a multiple of 2^-53.
  double uniform() noexcept { return static_cast<double>(bits() >> 11) * 0x1p-53; }

private:
  static constexpr std::uint64_t kStep = 0x9E3779B97F4A7C15u;
  static constexpr std::uint64_t mix(std::uint64_t z) noexcept {
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
  }
  std::uint64_t state_;
};

}  // namespace raymeter
