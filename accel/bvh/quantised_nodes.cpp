#include "accel/bvh/quantised_nodes.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/base/threads.h"

namespace raymeter {

namespace {

constexpr std::size_t kGrain = 1024;
constexpr float kFarthest = 0x1p120F;
constexpr int kLeastExponent = -126;

/// Steps along one axis. at() is the very expression of node_access_kernel.h: the product is exact, so that the sum is rounded once, fused or not.
class Steps {
public:
  /// From `least` to `greatest` in at most `most` steps.
  Steps(float least, float greatest, int most) : corner_(least), most_(most) {
    const double step = (double{greatest} - double{least}) / most;
    exponent_ = step > 0 ? std::max(std::ilogb(step), kLeastExponent) : kLeastExponent;
    while (at(most) < greatest) ++exponent_;
  }
  [[nodiscard]] float corner() const noexcept { return corner_; }
  [[nodiscard]] int exponent() const noexcept { return exponent_; }
  [[nodiscard]] float at(int steps) const noexcept { return corner_ + static_cast<float>(steps) * std::ldexp(1.0F, exponent_); }
  /// The last step that is no greater than `plane`.
  [[nodiscard]] int below(float plane) const noexcept {
    int steps = std::clamp(static_cast<int>(std::ceil(distance(plane))), 0, most_);
    while (at(steps) > plane) --steps;
    return steps;
  }
  /// The first step that is no less than `plane`.
  [[nodiscard]] int above(float plane) const noexcept {
    int steps = std::clamp(static_cast<int>(std::floor(distance(plane))), 0, most_);
    while (at(steps) < plane) ++steps;
    return steps;
  }

private:
  [[nodiscard]] double distance(float plane) const noexcept { return std::ldexp(double{plane} - double{corner_}, -exponent_); }

  float corner_;
  int exponent_;
  int most_;
};

int children_of(const WideNode& node) {
  int children = 0;
  while (children < kWideChildren && node.plane[0][children] <= node.plane[3][children]) ++children;
  return children;
}

Steps steps_of(const WideNode& node, int children, int axis, int bits) {
  const float least = *std::min_element(node.plane[axis], node.plane[axis] + children);
  const float greatest = *std::max_element(node.plane[axis + 3], node.plane[axis + 3] + children);
  if (!(least >= -kFarthest && greatest <= kFarthest)) throw Error("plane_bits: whole steps need boxes within 2^120 of the origin; expected 32 for this scene");
  return {least, greatest, (1 << bits) - 1};
}

template <class Plane>
void quantise(const WideNode& node, int bits, QuantisedNode<Plane>& to) {
  to = {};
  const int children = children_of(node);
  to.children = static_cast<std::uint8_t>(children);
  std::copy_n(node.child, kWideChildren, to.child);
  std::copy_n(node.order, 8, to.order);
  for (int a = 0; a < 3 && children > 0; ++a) {
    const Steps steps = steps_of(node, children, a, bits);
    to.corner[a] = steps.corner();
    to.exponent[a] = static_cast<std::int8_t>(steps.exponent());
    for (int c = 0; c < children; ++c) {
      to.plane[a][c] = static_cast<Plane>(steps.below(node.plane[a][c]));
      to.plane[a + 3][c] = static_cast<Plane>(steps.above(node.plane[a + 3][c]));
    }
  }
}

template <class Each>
void for_each_node(std::size_t count, Each each) {
  for_each_task((count + kGrain - 1) / kGrain, [&](std::size_t part) {
    for (std::size_t n = part * kGrain; n < std::min((part + 1) * kGrain, count); ++n) each(n);
  });
}

template <class Plane>
void quantise_all(std::span<const WideNode> nodes, int bits, Column<QuantisedNode<Plane>>& to) {
  to.resize_for_overwrite(nodes.size());
  for_each_node(nodes.size(), [&](std::size_t n) { quantise(nodes[n], bits, to[n]); });
}

}  // namespace

QuantisedNodes quantised_nodes(std::span<const WideNode> nodes, int bits) {
  QuantisedNodes quantised;
  if (bits <= 8)
    quantise_all(nodes, bits, quantised.by_bytes);
  else
    quantise_all(nodes, bits, quantised.by_words);
  return quantised;
}

void round_outwards(std::span<WideNode> nodes, int bits) {
  for_each_node(nodes.size(), [&](std::size_t n) {
    WideNode& node = nodes[n];
    const int children = children_of(node);
    for (int a = 0; a < 3 && children > 0; ++a) {
      const Steps steps = steps_of(node, children, a, bits);
      for (int c = 0; c < children; ++c) {
        node.plane[a][c] = steps.at(steps.below(node.plane[a][c]));
        node.plane[a + 3][c] = steps.at(steps.above(node.plane[a + 3][c]));
      }
    }
  });
}

}  // namespace raymeter
