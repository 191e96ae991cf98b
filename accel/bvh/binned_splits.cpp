#include "accel/bvh/binned_splits.h"

#include <algorithm>
#include <bit>

namespace raymeter {

Bins::Bins(int bins) noexcept {
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
  over_parts(
      boxes, bins,
      [&](Bins& sum, std::span<const BinnedBox> part) {
        for (const BinnedBox& one : part) {
          const Row4 place = mapping.place(one);
          for (int a = 0; a < 3; ++a) {
            const int b = mapping.bin(place, a);
            grow(sum.box[a][b], one.box);
            ++sum.entering[a][b];
          }
        }
      },
      [&](Bins& sum, const Bins& part) { sum.add(part, mapping.bins); });
  for (int a = 0; a < 3; ++a) std::copy_n(bins.entering[a], mapping.bins, bins.leaving[a]);
}

namespace {

using Mask4 = int __attribute__((vector_size(16)));

/// Adds the box unless `leave_out` has its bits set, without a branch: they make it NaN.
void add_unless(NodeBounds& bounds, const BinnedBox& one, int leave_out) noexcept {
  const Mask4 mask{leave_out, leave_out, leave_out, leave_out};
  const auto masked = [&](const Row4& row) { return std::bit_cast<Row4>(std::bit_cast<Mask4>(row) | mask); };
  const Row4 center2 = masked(one.box.min + one.box.max);
  grow(bounds.box, {masked(one.box.min), masked(one.box.max)});
  grow(bounds.centers2, {center2, center2});
}

}  // namespace

Halves partition(std::span<BinnedBox> boxes, const BinnedSplit& split, const BinMapping& mapping) {
  Halves halves;
  if (split.axis >= 0) {
    // Which side a box is on no branch can foresee: each changes places with the first of the right child, which moves on where that was wanted.
    std::size_t& left = halves.left_count;
    for (BinnedBox& box : boxes) {
      const BinnedBox one = box;
      const bool in_left = mapping.bin(mapping.place(one), split.axis) < split.bin;
      box = boxes[left];
      boxes[left] = one;
      left += in_left ? 1 : 0;
      add_unless(halves.left, one, in_left ? 0 : -1);
      add_unless(halves.right, one, in_left ? -1 : 0);
    }
    if (halves.left_count > 0 && halves.left_count < boxes.size()) return halves;
  }
  halves.left_count = boxes.size() / 2;
  halves.left = bounds_of(boxes.first(halves.left_count));
  halves.right = bounds_of(boxes.subspan(halves.left_count));
  return halves;
}

}  // namespace raymeter
