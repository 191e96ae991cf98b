#pragma once

#include <cstddef>
#include <cstdint>

#include "core/geometry/primitive_run.h"
#include "core/scene/pools_view.h"

namespace raymeter {

/// Eight bytes: an inner node's plane and where its two children stand, the lower one first; or a leaf's primitives.
struct KdNode {
  static constexpr int kTagBits = 3;
  static constexpr std::uint32_t kMostLinks = 1u << (32 - kTagBits);
  /// Tags below kRuns are the axes of planes; a leaf of kRuns has a run for each kind of primitive in it, or none; other leaves hold one kind, kKind + kind.
  static constexpr std::uint32_t kRuns = 3;
  static constexpr std::uint32_t kKind = 4;

  std::uint32_t word;  ///< the plane's position as bits; of a leaf the first reference or run
  std::uint32_t link;  ///< the tag, and above it the first child; of a leaf how many references or runs

  [[nodiscard]] std::uint32_t tag() const noexcept { return link & ((1u << kTagBits) - 1); }
  [[nodiscard]] bool leaf() const noexcept { return tag() >= kRuns; }
  [[nodiscard]] float plane() const noexcept { return __builtin_bit_cast(float, word); }
  [[nodiscard]] std::int32_t first_child() const noexcept { return static_cast<std::int32_t>(link >> kTagBits); }
  [[nodiscard]] std::int32_t first() const noexcept { return static_cast<std::int32_t>(word); }
  [[nodiscard]] std::int32_t count() const noexcept { return static_cast<std::int32_t>(link >> kTagBits); }
  [[nodiscard]] bool empty() const noexcept { return link == kRuns; }
};

/// A k-d tree; node 0 is the root, node 1 unused, so that pairs of children are aligned.
struct KdView {
  PoolsView pools;
  const KdNode* nodes;
  const std::int32_t* refs;  ///< positions in the pool of a leaf's kind
  const PrimitiveRun* runs;  ///< of `refs`
  float box[6];              ///< around all that can be hit: min x y z, max x y z
  float largest_size;        ///< of any primitive, its diameter or more
  std::int32_t stack_capacity;
  bool frustum;
  bool mailbox;
};

/// Where all rays of a packet are in a node, or in between.
struct KdSpan {
  float t_near;
  float t_far;
};

/// Bytes of traversal stack: per entry both ends of a packet's intervals (whole registers of any width), the registers that are in it, a span and a node.
[[nodiscard]] constexpr std::size_t kd_stack_bytes(std::int32_t capacity, std::int32_t packet) noexcept {
  const std::size_t row = static_cast<std::size_t>(packet + 15) / 16 * 16;
  return static_cast<std::size_t>(capacity) * (2 * row * sizeof(float) + sizeof(std::uint64_t) + sizeof(KdSpan) + sizeof(std::int32_t));
}

}  // namespace raymeter
