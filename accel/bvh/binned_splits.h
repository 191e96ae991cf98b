#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "accel/bvh/binning_layout.h"
#include "core/base/threads.h"
#include "core/bounds/aabb.h"

namespace raymeter {

// Splits by centres over bins, after Wald 2007, "On fast construction of SAH-based bounding volume hierarchies": what top-down builders share. Large nodes are
// binned in parallel over fixed parts, which are merged in order, so that the tree is the same on any number of threads.

inline constexpr std::size_t kParallelBoxes = 16384;  ///< smaller subtrees are built by one task
inline constexpr int kBalanceDepth = 64;              ///< deeper nodes are halved, so that no input makes a deep tree

/// What is NaN in `other` is left out.
inline void grow(Box4& box, const Box4& other) noexcept {
  box.min = other.min < box.min ? other.min : box.min;
  box.max = other.max > box.max ? other.max : box.max;
}

[[nodiscard]] inline float half_area(const Box4& box) noexcept {
  const float x = box.max[0] - box.min[0], y = box.max[1] - box.min[1], z = box.max[2] - box.min[2];
  return x * y + y * z + z * x;
}

[[nodiscard]] inline Aabb to_aabb(const Box4& box) noexcept { return {{box.min[0], box.min[1], box.min[2]}, {box.max[0], box.max[1], box.max[2]}}; }

inline BinnedBox::BinnedBox(const Aabb& around, PrimRef prim) noexcept
    : box{{around.min.x, around.min.y, around.min.z, std::bit_cast<float>(kNormal | prim.kind_bits << 31)},
          {around.max.x, around.max.y, around.max.z, std::bit_cast<float>(kNormal | prim.index | prim.kind_bits >> 1 << 31)}} {}
inline PrimRef BinnedBox::prim() const noexcept {
  const auto low = std::bit_cast<std::uint32_t>(box.min[3]), high = std::bit_cast<std::uint32_t>(box.max[3]);
  return {(low >> 31 | high >> 31 << 1) & 3u, high & 0x1FFFFFFFu};
}
inline Aabb BinnedBox::aabb() const noexcept { return to_aabb(box); }

/// What is needed to split a node: the bounds of its boxes and of (twice) their centres.
struct NodeBounds {
  Box4 box = kEmptyBox4;
  Box4 centers2 = kEmptyBox4;
  void add(const BinnedBox& one) noexcept {
    grow(box, one.box);
    const Row4 center2 = one.box.min + one.box.max;
    grow(centers2, {center2, center2});
  }
  void add(const NodeBounds& other) noexcept {
    grow(box, other.box);
    grow(centers2, other.centers2);
  }
};

/// Bins for so many boxes: where there are few, many bins cost more than they tell.
[[nodiscard]] inline int bin_count(int most, std::size_t boxes) noexcept {
  return std::min(most, static_cast<int>(4 + std::min<std::size_t>(boxes, 8 * kMaxBins) / 8));
}

struct BinnedSplit {
  float cost = kInfinite;  ///< of the children, in half areas times boxes
  int axis = -1;
  int bin = 0;  ///< the first of the right child
};

/// A child as the bins tell it.
struct BinnedSide {
  Box4 box = kEmptyBox4;
  std::int32_t count = 0;
};

/// The cheapest border between bins.
[[nodiscard]] BinnedSplit cheapest(const Bins& bins, int bin_count) noexcept;
/// The children of a split that there is.
[[nodiscard]] std::pair<BinnedSide, BinnedSide> sides(const Bins& bins, int bin_count, const BinnedSplit& split) noexcept;

/// Calls body(sum, part of boxes) for fixed parts, in parallel where there are many boxes; adds the sums to `sum` in order by merge(sum, of part).
template <class Sum, class Body, class Merge>
void over_parts(std::span<const BinnedBox> boxes, Sum& sum, Body&& body, Merge&& merge) {
  constexpr std::size_t kPart = 8192;
  if (boxes.size() < kParallelBoxes) return body(sum, boxes);
  std::vector<Sum> sums((boxes.size() + kPart - 1) / kPart, sum);
  for_each_task(sums.size(), [&](std::size_t part) { body(sums[part], boxes.subspan(part * kPart, std::min(kPart, boxes.size() - part * kPart))); });
  for (const Sum& part : sums) merge(sum, part);
}

[[nodiscard]] NodeBounds bounds_of(std::span<const BinnedBox> boxes);
/// Makes the bins of all boxes.
void bin_centers(std::span<const BinnedBox> boxes, const BinMapping& mapping, Bins& bins);

/// The cheapest split by centres, and its children.
struct CenterSplit : BinnedSplit {
  BinnedSide left, right;
};
[[nodiscard]] CenterSplit split_by_centers(std::span<const BinnedBox> boxes, const BinMapping& mapping);

/// How many of a node's boxes stand in front for its left child, and the children's bounds.
struct Halves {
  std::size_t left_count = 0;
  NodeBounds left;
  NodeBounds right;
};
/// Brings the boxes of the left child to the front. Without a split, or with one that leaves a side empty, the node is halved as it lies.
[[nodiscard]] Halves partition(std::span<BinnedBox> boxes, const CenterSplit& split, const BinMapping& mapping);

}  // namespace raymeter
