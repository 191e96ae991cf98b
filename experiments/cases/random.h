#pragma once

#include <cmath>
#include <cstdint>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "core/base/random.h"

namespace raymeter::cases {

/// Random numbers of hard cases and of tests, the same everywhere.
class Random {
public:
  explicit Random(std::uint64_t seed) noexcept : stream_(seed, 0) {}
  double uniform(double low = 0, double high = 1) noexcept { return low + (high - low) * stream_.uniform(); }
  std::size_t below(std::size_t n) noexcept { return static_cast<std::size_t>(stream_.bits() % n); }
  std::uint32_t bits() noexcept { return static_cast<std::uint32_t>(stream_.bits() >> 32); }
  glm::dvec3 in_cube(double half = 1) noexcept {
    const double x = uniform(-half, half), y = uniform(-half, half);
    return {x, y, uniform(-half, half)};
  }
  /// Uniform on the unit sphere.
  glm::dvec3 direction() noexcept {
    for (;;) {
      const glm::dvec3 v = in_cube();
      const double length2 = glm::dot(v, v);
      if (length2 > 1e-4 && length2 <= 1) return v / std::sqrt(length2);
    }
  }

private:
  RandomStream stream_;
};

}  // namespace raymeter::cases
