#pragma once

#include <cstddef>
#include <cstdint>

namespace raymeter {

/// What is counted. Each kernel file says at its top what one event means there.
enum class Event : std::uint8_t {
  node_visit,        ///< an interior node is opened, a cell is stepped into
  leaf_visit,        ///< a leaf (elementary cell) is entered
  empty_leaf_visit,  ///< the same, where it holds no primitive
  volume_test,       ///< a ray is tested against a bounding volume
  prim_test,         ///< a ray is tested against a primitive
  prim_hit,          ///< such a test found a hit inside the ray's interval
  cache_test,        ///< a cached blocker is tested
  cache_hit,         ///< and blocks
};
inline constexpr std::size_t kEventCount = 8;

/// Sums of one run. `rays` counts live lanes, `packets` the times a register-wide test was executed: the cost SIMD really pays.
struct Counters {
  std::uint64_t rays[kEventCount] = {};
  std::uint64_t packets[kEventCount] = {};
  std::uint64_t ray_count = 0;

  constexpr void add(const Counters& other) noexcept {
    for (std::size_t e = 0; e < kEventCount; ++e) {
      rays[e] += other.rays[e];
      packets[e] += other.packets[e];
    }
    ray_count += other.ray_count;
  }
  [[nodiscard]] constexpr std::uint64_t live(Event e) const noexcept { return rays[static_cast<std::size_t>(e)]; }
  [[nodiscard]] constexpr std::uint64_t executed(Event e) const noexcept { return packets[static_cast<std::size_t>(e)]; }

  friend constexpr bool operator==(const Counters&, const Counters&) = default;
};

}  // namespace raymeter
