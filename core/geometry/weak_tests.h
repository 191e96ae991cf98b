#pragma once

#include <cstdint>

namespace raymeter {

/// Textbook tests beside the robust ones, to show what robustness costs and what it saves from. Nothing is promised of their answers.
enum class TriangleTest : std::uint8_t {
  woop_kahan,
  woop,
  moeller_trumbore,
  moeller_trumbore_double,
  moeller_trumbore_epsilon,
  pluecker,
  pluecker_epsilon,
  baldwin_weber
};
enum class SphereTest : std::uint8_t { robust, naive, haines };

}  // namespace raymeter
