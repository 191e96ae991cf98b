#include "accel/bvh/binned_splits.h"

#include <algorithm>

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

Halves partition(std::span<BinnedBox> boxes, const BinnedSplit& split, const BinMapping& mapping) {
  Halves halves;
  if (split.axis >= 0) {
    const auto in_left = [&](std::size_t i) { return mapping.bin(mapping.place(boxes[i]), split.axis) < split.bin; };
    std::size_t end = boxes.size();
    for (std::size_t& i = halves.left_count;;) {
      while (i < end && in_left(i)) halves.left.add(boxes[i++]);
      while (i < end && !in_left(end - 1)) halves.right.add(boxes[--end]);
      if (i == end) break;
      std::swap(boxes[i], boxes[end - 1]);
    }
    if (halves.left_count > 0 && halves.left_count < boxes.size()) return halves;
  }
  halves.left_count = boxes.size() / 2;
  halves.left = bounds_of(boxes.first(halves.left_count));
  halves.right = bounds_of(boxes.subspan(halves.left_count));
  return halves;
}

}  // namespace raymeter
