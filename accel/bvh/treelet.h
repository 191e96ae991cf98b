#pragma once

#include <array>
#include <cmath>

#include "accel/bvh/wide_cuts.h"

namespace raymeter {

/// The children of one wide node, and the binary treelet above them, which knows what is in front of what.
class Treelet {
public:
  /// Of the wide node in place of node n.
  Treelet(const WideCuts& cuts, std::int32_t n) {
    if (cuts.is_leaf(n))
      child_[static_cast<std::size_t>(children_++)] = n;
    else
      open(cuts, n, cuts.left_roots_below(n), kWideChildren);
  }
  /// Nodes of the binary tree.
  [[nodiscard]] std::span<const std::int32_t> children() const { return std::span(child_).first(static_cast<std::size_t>(children_)); }
  /// Places of the children, front to back.
  [[nodiscard]] std::uint32_t order(std::uint32_t octant) const {
    std::uint32_t places = 0;
    int next = 0;
    if (splits_ > 0) list(0, octant, places, next);
    for (int place = children_; next < kWideChildren; ++place, ++next) places |= static_cast<std::uint32_t>(place % kWideChildren) << 4 * next;
    return places;
  }

private:
  struct Split {
    std::array<int, 2> part;  ///< below 8: a child, else 8 + another split; the one of the smaller coordinate first
    int axis;
  };

  int add(const WideCuts& cuts, std::int32_t n, int roots) {
    const int left = cuts.left_roots(n, roots);
    if (left != 0) return kWideChildren + open(cuts, n, left, roots);
    child_[static_cast<std::size_t>(children_)] = n;
    return children_++;
  }
  int open(const WideCuts& cuts, std::int32_t n, int left_roots, int roots) {
    const int self = splits_++;
    const std::int32_t first = cuts.at(n).first;
    const glm::vec3 apart = cuts.at(first + 1).box.center2() - cuts.at(first).box.center2();
    Split made{};
    for (int a = 1; a < 3; ++a) {
      if (std::abs(apart[a]) > std::abs(apart[made.axis])) made.axis = a;
    }
    const int left = add(cuts, first, left_roots);
    const int right = add(cuts, first + 1, roots - left_roots);
    made.part = apart[made.axis] >= 0 ? std::array{left, right} : std::array{right, left};
    split_[static_cast<std::size_t>(self)] = made;
    return self;
  }
  void list(int at, std::uint32_t octant, std::uint32_t& places, int& next) const {
    const Split& here = split_[static_cast<std::size_t>(at)];
    const std::size_t near = octant >> here.axis & 1;
    for (const std::size_t side : {near, 1 - near}) {
      const int part = here.part[side];
      if (part >= kWideChildren)
        list(part - kWideChildren, octant, places, next);
      else
        places |= static_cast<std::uint32_t>(part) << 4 * next++;
    }
  }

  std::array<std::int32_t, kWideChildren> child_{};
  std::array<Split, kWideChildren> split_{};
  int children_ = 0;
  int splits_ = 0;
};

}  // namespace raymeter
