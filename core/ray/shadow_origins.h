#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/column.h"

namespace raymeter {

/// Positions in the binary tree of the rays of a pixel, numbered as in a heap: the eye ray has 1; reflections go left, refractions right. Below the last
/// numbered level a ray shares its parent's number, so that tables by number stay small.
struct RayTree {
  static constexpr std::int32_t kEye = 1;
  static constexpr std::int32_t kNodes = 256;  ///< numbers are below: eight levels

  [[nodiscard]] static constexpr std::int32_t reflection(std::int32_t node) noexcept { return 2 * node < kNodes ? 2 * node : node; }
  [[nodiscard]] static constexpr std::int32_t refraction(std::int32_t node) noexcept { return 2 * node < kNodes ? 2 * node + 1 : node; }
};

/// Where the rays of a shadow batch come from: what techniques that learn from earlier shadow rays go by. Columns as long as the batch; empty where there are
/// no shadow rays.
struct ShadowOrigins {
  Column<std::int32_t> light;         ///< number of the light in the scene that the ray goes to
  Column<std::int32_t> source;        ///< primitive that it leaves
  std::int32_t node = RayTree::kEye;  ///< of the rays that hit these primitives

  [[nodiscard]] std::size_t size() const noexcept { return light.size(); }
  void push_back(std::int32_t to_light, std::int32_t from_prim) {
    light.push_back(to_light);
    source.push_back(from_prim);
  }
  void reserve(std::size_t size) {
    light.reserve(size);
    source.reserve(size);
  }
  void resize(std::size_t size) {
    light.resize(size);
    source.resize(size);
  }
};

}  // namespace raymeter
