#pragma once

#include <cstddef>
#include <cstdint>

#include "core/geometry/primitive_run.h"
#include "core/ray/views.h"
#include "core/scene/pools_view.h"

namespace raymeter {

/// A child as its parent sees it: its box (min x y z, max x y z) and what is there. 32 bytes; the children of a node are consecutive, so that the two of a
/// binary node share a cache line.
struct alignas(32) BvhLink {
  static constexpr std::uint32_t kInner = 8;  ///< first = its first child's link, count = children
  static constexpr std::uint32_t kRuns = 9;   ///< a leaf of several kinds: first = its first run, count = runs
  float box[6];
  std::uint32_t tag_and_count;  ///< tag in the upper 4 bits: kInner, kRuns, or a primitive kind: a leaf that is one run
  std::int32_t first;

  [[nodiscard]] constexpr std::uint32_t tag() const noexcept { return tag_and_count >> PrimitiveRun::kCountBits; }
  [[nodiscard]] constexpr std::int32_t count() const noexcept { return static_cast<std::int32_t>(tag_and_count & ((1u << PrimitiveRun::kCountBits) - 1)); }
};

/// A tree of links; link 0 is the root, link 1 is unused.
struct BvhView {
  const BvhLink* links;
  const PrimitiveRun* runs;
  PoolsView pools;  ///< in leaf order
  std::int32_t stack_capacity;
};

/// Bytes of traversal stack: per entry the entry distances of a packet, a sort key, a link and a row.
[[nodiscard]] constexpr std::size_t bvh_stack_bytes(std::int32_t capacity) noexcept {
  return static_cast<std::size_t>(capacity) * ((kMaxPacket + 1) * sizeof(float) + 2 * sizeof(std::int32_t));
}

}  // namespace raymeter
