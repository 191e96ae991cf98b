#pragma once

#include "accel/volume_links_layout.h"

namespace raymeter {

/// A tree of links; link 0 is the root, link 1 is unused, so that pairs of children are aligned. Primitives are in the order of the leaves.
template <class Layout>
struct BvhView : VolumeLinksView<Layout> {
  std::int32_t stack_capacity;
  std::int32_t heap_capacity;
};

/// Bytes of traversal stack: per entry the entry distances of a packet (whole registers of any width), a sort key, a link and a row.
[[nodiscard]] constexpr std::size_t bvh_stack_bytes(std::int32_t capacity, std::int32_t packet) noexcept {
  const std::size_t row = static_cast<std::size_t>(packet + 15) / 16 * 16;
  return static_cast<std::size_t>(capacity) * ((row + 1) * sizeof(float) + 2 * sizeof(std::int32_t));
}

/// Bytes of traversal heap: per entry the lanes that met the volume, the key and the link.
[[nodiscard]] constexpr std::size_t bvh_heap_bytes(std::int32_t capacity) noexcept {
  return static_cast<std::size_t>(capacity) * (sizeof(std::uint64_t) + sizeof(float) + sizeof(std::int32_t));
}

}  // namespace raymeter
