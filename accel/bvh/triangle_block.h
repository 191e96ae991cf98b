#pragma once

#include <cstdint>
#include <span>

#include "accel/bvh/binned_splits.h"
#include "accel/bvh/wide_layout.h"
#include "core/scene/pools.h"

namespace raymeter {

/// The different vertices of triangles that may become a block. A vertex is compared with all others at once, and none waits for what was stored of the one
/// before: how far a search goes is what no branch can foresee.
class SharedVertices {
public:
  SharedVertices() = default;
  /// Those of a block's triangles at most; `number` gets each corner's vertex, numbered in the order in which they first occur, where it is not null.
  SharedVertices(const TrianglePool& pool, std::span<const PrimRef> triangles, std::uint8_t (*number)[TriangleBlock::kTriangles] = nullptr) noexcept;
  /// Those of another set too; false where they are too many for a block: then the set is of no more use.
  [[nodiscard]] bool add(const SharedVertices& others) noexcept;
  [[nodiscard]] int count() const noexcept { return count_; }
  [[nodiscard]] float at(int axis, int i) const noexcept { return at_[axis][i]; }

private:
  static constexpr int kMost = 3 * TriangleBlock::kTriangles;
  alignas(16) float at_[3][kMost];  ///< beyond count_ anything
  int count_ = 0;
};

/// Whether primitives may be a leaf of a wide tree: of one kind, triangles that fit a block, or no more than `max_leaf_size` others.
[[nodiscard]] bool fits_leaf(const Pools& pools, std::span<const PrimRef> refs, int max_leaf_size) noexcept;

/// Fills a block with triangles of a scene; false where they do not fit.
[[nodiscard]] bool fill_block(const TrianglePool& pool, std::span<const PrimRef> refs, TriangleBlock& block) noexcept;

}  // namespace raymeter
