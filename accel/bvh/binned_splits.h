#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "core/base/threads.h"
#include "core/bounds/aabb.h"

namespace raymeter {

// Splits by centres over bins, after Wald 2007, "On fast construction of SAH-based bounding volume hierarchies": what top-down builders share. Large nodes are
// binned in parallel over fixed parts, which are merged in order, so that the tree is the same on any number of threads.

inline constexpr int kMaxBins = 64;
inline constexpr std::size_t kParallelBoxes = 16384;  ///< smaller subtrees are built by one task
inline constexpr int kBalanceDepth = 64;              ///< deeper nodes are halved, so that no input makes a deep tree

/// Four floats in one register, as the GNU dialect has them.
using Row4 = float __attribute__((vector_size(16)));

/// Box of rows; the fourth elements are free for other use.
struct Box4 {
  Row4 min;
  Row4 max;
};
inline constexpr float kInfinite = std::numeric_limits<float>::infinity();
inline constexpr Box4 kEmptyBox4{{kInfinite, kInfinite, kInfinite, kInfinite}, {-kInfinite, -kInfinite, -kInfinite, -kInfinite}};

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

/// The box of a primitive or of a part of one, and in the fourth row elements which primitive it is: patterns of numbers that are not denormal, which would be
/// slow to calculate with. The sign bits hold the kind.
struct BinnedBox {
  Box4 box;
  BinnedBox() = default;
  BinnedBox(const Aabb& around, PrimRef prim) noexcept
      : box{{around.min.x, around.min.y, around.min.z, std::bit_cast<float>(kNormal | prim.kind_bits << 31)},
            {around.max.x, around.max.y, around.max.z, std::bit_cast<float>(kNormal | prim.index | prim.kind_bits >> 1 << 31)}} {}
  [[nodiscard]] PrimRef prim() const noexcept {
    const auto low = std::bit_cast<std::uint32_t>(box.min[3]), high = std::bit_cast<std::uint32_t>(box.max[3]);
    return {(low >> 31 | high >> 31 << 1) & 3u, high & 0x1FFFFFFFu};
  }
  [[nodiscard]] Aabb aabb() const noexcept { return to_aabb(box); }

private:
  static constexpr std::uint32_t kNormal = 0x40000000;
};

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

/// Maps centres to bins; axes without extent map to bin 0 and are never split.
struct BinMapping {
  int bins;
  Row4 offset;
  Row4 scale;
  BinMapping(const Box4& centers2, int bin_count) noexcept : bins(bin_count) {
    offset = centers2.min;
    for (int a = 0; a < 4; ++a) {
      const float extent = centers2.max[a] - centers2.min[a];
      const float factor = static_cast<float>(bins) * 0.99999f / extent;
      scale[a] = a < 3 && extent > 0 && factor < kInfinite ? factor : 0.0f;
    }
  }
  /// The bins that a box belongs to, by axis.
  [[nodiscard]] auto bins_of(const BinnedBox& one) const noexcept {
    using Ints4 = std::int32_t __attribute__((vector_size(16)));
    const auto last = static_cast<float>(bins - 1);
    const Row4 place = (one.box.min + one.box.max - offset) * scale, most{last, last, last, last};
    return __builtin_convertvector(place < most ? place : most, Ints4);
  }
};

/// Bins for so many boxes: where there are few, many bins cost more than they tell.
[[nodiscard]] inline int bin_count(int most, std::size_t boxes) noexcept {
  return std::min(most, static_cast<int>(4 + std::min<std::size_t>(boxes, 8 * kMaxBins) / 8));
}

/// On each axis the boxes of bins, and how many boxes begin and end in them: of splits by centres, all in one.
struct Bins {
  Box4 box[3][kMaxBins];
  std::int32_t entering[3][kMaxBins];
  std::int32_t leaving[3][kMaxBins];
  explicit Bins(int bins) noexcept;  ///< the others are not looked at
  void add(const Bins& other, int bins) noexcept;
};

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
