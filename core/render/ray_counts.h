#pragma once

#include <cstdint>
#include <vector>

namespace raymeter {

/// Rays of an image by kind. `refraction` is without the totally reflected ones, which `tir` counts.
struct RayCounts {
  std::int64_t primary = 0;
  std::int64_t primary_hit = 0;
  std::int64_t reflection = 0;
  std::int64_t reflection_hit = 0;
  std::int64_t refraction = 0;
  std::int64_t refraction_hit = 0;
  std::int64_t tir = 0;
  std::int64_t shadow = 0;
  std::int64_t shadow_blocked = 0;

  [[nodiscard]] std::int64_t all() const noexcept { return primary + reflection + refraction + shadow; }
  void add(const RayCounts& other) noexcept;
  friend bool operator==(const RayCounts&, const RayCounts&) = default;
};

/// How deep the rays of an image go.
struct DepthCounts {
  std::vector<std::int64_t> generation;  ///< eye, reflection and refraction rays of depth 1, 2, ...
  std::int64_t deepest_sum = 0;          ///< over all eye rays, the depth of the deepest ray that comes of it

  void add(const DepthCounts& other);
  /// Mean of the deepest generations; 0 where there are no eye rays.
  [[nodiscard]] double mean() const noexcept { return generation.empty() ? 0 : static_cast<double>(deepest_sum) / static_cast<double>(generation.front()); }
  friend bool operator==(const DepthCounts&, const DepthCounts&) = default;
};

}  // namespace raymeter
