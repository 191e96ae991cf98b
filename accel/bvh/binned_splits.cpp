#include "accel/bvh/binned_splits.h"

#include <algorithm>
#include <bit>
#include <tuple>

#include "accel/bvh/binning_kernel.h"
#include "accel/kernel_set.h"

namespace raymeter {

void Bins::clear(int bins) noexcept {
  for (int a = 0; a < 3; ++a) {
    std::fill_n(box[a], bins, kEmptyBox4);
    std::fill_n(entering[a], bins, 0);
    std::fill_n(leaving[a], bins, 0);
  }
}

void Bins::add(const Bins& other, int bins) noexcept {
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < bins; ++b) {
      grow(box[a][b], other.box[a][b]);
      entering[a][b] += other.entering[a][b];
      leaving[a][b] += other.leaving[a][b];
    }
  }
}

BinnedSplit cheapest(const Bins& bins, int bin_count) noexcept {
  BinnedSplit best;
  for (int a = 0; a < 3; ++a) {
    float right_cost[kMaxBins];
    BinnedSide side;
    for (int b = bin_count - 1; b > 0; --b) {
      grow(side.box, bins.box[a][b]);
      side.count += bins.leaving[a][b];
      right_cost[b] = side.count > 0 ? half_area(side.box) * static_cast<float>(side.count) : kInfinite;
    }
    side = {};
    for (int b = 1; b < bin_count; ++b) {
      grow(side.box, bins.box[a][b - 1]);
      side.count += bins.entering[a][b - 1];
      const float cost = side.count > 0 ? half_area(side.box) * static_cast<float>(side.count) + right_cost[b] : kInfinite;
      if (cost < best.cost) best = {cost, a, b};
    }
  }
  return best;
}

std::pair<BinnedSide, BinnedSide> sides(const Bins& bins, int bin_count, const BinnedSplit& split) noexcept {
  std::pair<BinnedSide, BinnedSide> both;
  for (int b = 0; b < bin_count; ++b) {
    BinnedSide& side = b < split.bin ? both.first : both.second;
    grow(side.box, bins.box[split.axis][b]);
    side.count += b < split.bin ? bins.entering[split.axis][b] : bins.leaving[split.axis][b];
  }
  return both;
}

NodeBounds bounds_of(std::span<const BinnedBox> boxes) {
  NodeBounds bounds;
  over_parts(
      boxes, bounds,
      [](NodeBounds& sum, std::span<const BinnedBox> part) {
        for (const BinnedBox& one : part) sum.add(one);
      },
      [](NodeBounds& sum, const NodeBounds& part) { sum.add(part); });
  return bounds;
}

void bin_centers(std::span<const BinnedBox> boxes, const BinMapping& mapping, Bins& bins) {
  static const auto bin = for_isa(best_isa(), []<Isa I>() { return BinningKernel<I>::bin; });
  if (boxes.size() < kParallelBoxes) return bin(boxes.data(), boxes.size(), mapping, bins);
  bins.clear(mapping.bins);
  over_parts(
      boxes, bins, [&](Bins& sum, std::span<const BinnedBox> part) { bin(part.data(), part.size(), mapping, sum); },
      [&](Bins& sum, const Bins& part) { sum.add(part, mapping.bins); });
}

CenterSplit split_by_centers(std::span<const BinnedBox> boxes, const BinMapping& mapping) {
  Bins bins;
  bin_centers(boxes, mapping, bins);
  CenterSplit split{cheapest(bins, mapping.bins), {}, {}};
  if (split.axis >= 0) std::tie(split.left, split.right) = sides(bins, mapping.bins, split);
  return split;
}

namespace {

using Mask4 = std::int32_t __attribute__((vector_size(16)));

Row4 splat(float value) noexcept { return Row4{value, value, value, value}; }

/// Grows by a point unless `leave_out` has its bits set, without a branch: they make it NaN.
void grow_unless(Box4& box, const Row4& point, const Mask4& leave_out) noexcept {
  const auto kept = std::bit_cast<Row4>(std::bit_cast<Mask4>(point) | leave_out);
  grow(box, {kept, kept});
}

/// Which side a box is on no branch can foresee: each changes places with the first of the right child, which moves on where that was wanted.
Halves put_left_first(std::span<BinnedBox> boxes, const CenterSplit& split, const BinMapping& mapping) noexcept {
  Halves halves{0, {split.left.box, kEmptyBox4}, {split.right.box, kEmptyBox4}};
  Box4 left_centers2 = kEmptyBox4, right_centers2 = kEmptyBox4;
  const Row4 offset = splat(mapping.offset[split.axis]), scale = splat(mapping.scale[split.axis]), border = splat(static_cast<float>(split.bin));
  BinnedBox* first_right = boxes.data();
  for (BinnedBox& box : boxes) {
    const Row4 place = (splat(box.box.min[split.axis]) + splat(box.box.max[split.axis]) - offset) * scale;
    const Mask4 in_left = place < border;
    const BinnedBox one = box;
    box = *first_right;
    *first_right = one;
    first_right -= in_left[0];
    const Row4 center2 = one.box.min + one.box.max;
    grow_unless(left_centers2, center2, ~in_left);
    grow_unless(right_centers2, center2, in_left);
  }
  halves.left_count = static_cast<std::size_t>(first_right - boxes.data());
  halves.left.centers2 = left_centers2;
  halves.right.centers2 = right_centers2;
  return halves;
}

}  // namespace

Halves partition(std::span<BinnedBox> boxes, const CenterSplit& split, const BinMapping& mapping) {
  if (split.axis >= 0) {
    const Halves halves = put_left_first(boxes, split, mapping);
    if (halves.left_count > 0 && halves.left_count < boxes.size()) return halves;
  }
  Halves halves;
  halves.left_count = boxes.size() / 2;
  halves.left = bounds_of(boxes.first(halves.left_count));
  halves.right = bounds_of(boxes.subspan(halves.left_count));
  return halves;
}

}  // namespace raymeter
