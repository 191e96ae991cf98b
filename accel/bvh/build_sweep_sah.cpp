// Full-sweep SAH: Goldsmith & Salmon's cost (1987) minimised top-down over all splits of the sorted centres, MacDonald & Booth 1990; in the form of Wald 2007,
// section 3 ("On fast construction of SAH-based bounding volume hierarchies"). Boxes are sorted once per axis (Wald & Havran 2006 do so for k-d trees); a split
// partitions the three lists stably, so that they stay sorted: O(n log n) in all. The lists belong to disjoint ranges in disjoint subtrees, which are built in
// parallel.

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>
#include <numeric>

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_sort.h>

#include "accel/bvh/box_builders.h"
#include "accel/bvh/build_prims.h"
#include "accel/bvh/sweep_sah.h"
#include "core/base/threads.h"

namespace raymeter {

namespace {

constexpr std::int32_t kParallelBoxes = 4096;  // smaller subtrees are built by one task
constexpr int kBalanceDepth = 64;              // deeper nodes are halved, so that no input makes a deep tree
constexpr float kInf = std::numeric_limits<float>::infinity();

struct Split {
  float cost = kInf;  // of the children, in half areas times boxes
  int axis = -1;
  std::int32_t middle = 0;
};

class SweepSah {
public:
  SweepSah(std::span<const Aabb> boxes, const SahParams& params)
      : boxes_(boxes), params_(params), node_cost_(static_cast<float>(params.node_cost)), left_(boxes.size()), scratch_(boxes.size()) {
    tbb::parallel_for(0, 3, [&](int axis) {
      std::vector<std::int32_t>& list = sorted_[static_cast<std::size_t>(axis)];
      list.resize(boxes.size());
      std::iota(list.begin(), list.end(), 0);
      tbb::parallel_sort(list.begin(), list.end(), [&](std::int32_t p, std::int32_t q) {
        const float center_p = box(p).center2()[axis], center_q = box(q).center2()[axis];
        return center_p != center_q ? center_p < center_q : p < q;
      });
      right_cost_[static_cast<std::size_t>(axis)].resize(boxes.size());
    });
  }

  BoxTree build() {
    BoxTree tree;
    if (boxes_.empty()) return tree;
    nodes_.resize(2 * boxes_.size());
    next_node_ = 1;
    split(0, 0, static_cast<std::int32_t>(boxes_.size()), 0);
    nodes_.resize(static_cast<std::size_t>(next_node_));
    tree.nodes = std::move(nodes_);
    tree.order = std::move(sorted_[0]);
    return tree;
  }

private:
  [[nodiscard]] const Aabb& box(std::int32_t i) const noexcept { return boxes_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] std::int32_t at(int axis, std::int32_t position) const noexcept {
    return sorted_[static_cast<std::size_t>(axis)][static_cast<std::size_t>(position)];
  }

  /// The best split of [first, last) along an axis; the boxes before and behind it are grown from both ends.
  Split sweep(int axis, std::int32_t first, std::int32_t last) {
    std::vector<float>& right_cost = right_cost_[static_cast<std::size_t>(axis)];
    Aabb grown;
    for (std::int32_t i = last - 1; i > first; --i) {
      grown.grow(box(at(axis, i)));
      right_cost[static_cast<std::size_t>(i)] = grown.half_area() * static_cast<float>(last - i);
    }
    Split best;
    grown = Aabb();
    for (std::int32_t i = first + 1; i < last; ++i) {
      grown.grow(box(at(axis, i - 1)));
      const float cost = grown.half_area() * static_cast<float>(i - first) + right_cost[static_cast<std::size_t>(i)];
      if (cost < best.cost) best = {cost, axis, i};
    }
    return best;
  }

  Split best_split(std::int32_t first, std::int32_t last) {
    std::array<Split, 3> splits;
    if (last - first >= kParallelBoxes) {
      tbb::parallel_for(0, 3, [&](int axis) { splits[static_cast<std::size_t>(axis)] = sweep(axis, first, last); });
    } else {
      for (int axis = 0; axis < 3; ++axis) splits[static_cast<std::size_t>(axis)] = sweep(axis, first, last);
    }
    return *std::min_element(splits.begin(), splits.end(), [](const Split& a, const Split& b) { return a.cost < b.cost; });
  }

  void split(std::int32_t node, std::int32_t first, std::int32_t last, int depth) {
    const std::int32_t count = last - first;
    Aabb bounds;
    for (std::int32_t i = first; i < last; ++i) bounds.grow(box(at(0, i)));
    nodes_[static_cast<std::size_t>(node)].box = bounds;
    Split best = count > 1 && depth < kBalanceDepth ? best_split(first, last) : Split();
    const float area = bounds.half_area();
    const bool worth_it = node_cost_ * area + best.cost < static_cast<float>(count) * area;
    if (count == 1 || (count <= params_.max_leaf_size && !worth_it)) {
      nodes_[static_cast<std::size_t>(node)].first = first;
      nodes_[static_cast<std::size_t>(node)].prim_count = count;
      return;
    }
    if (best.axis < 0) best = {0, 0, first + count / 2};
    partition(first, last, best);
    const std::int32_t child = next_node_.fetch_add(2);
    nodes_[static_cast<std::size_t>(node)].first = child;
    nodes_[static_cast<std::size_t>(node)].child_count = 2;
    const auto left = [&] { split(child, first, best.middle, depth + 1); };
    const auto right = [&] { split(child + 1, best.middle, last, depth + 1); };
    if (count >= kParallelBoxes) {
      tbb::parallel_invoke(left, right);
    } else {
      left();
      right();
    }
  }

  /// Brings the left child's boxes to the front of all three lists, without changing their order.
  void partition(std::int32_t first, std::int32_t last, const Split& best) {
    for (std::int32_t i = first; i < last; ++i) left_[static_cast<std::size_t>(at(best.axis, i))] = i < best.middle;
    for (int axis = 0; axis < 3; ++axis) {
      if (axis == best.axis) continue;
      std::vector<std::int32_t>& list = sorted_[static_cast<std::size_t>(axis)];
      auto kept = list.begin() + first;
      auto moved = scratch_.begin() + first;
      for (auto i = kept; i != list.begin() + last; ++i) {
        if (left_[static_cast<std::size_t>(*i)] != 0)
          *kept++ = *i;
        else
          *moved++ = *i;
      }
      std::copy(scratch_.begin() + first, moved, kept);
    }
  }

  std::span<const Aabb> boxes_;
  SahParams params_;
  float node_cost_;
  std::array<std::vector<std::int32_t>, 3> sorted_;
  std::array<std::vector<float>, 3> right_cost_;
  std::vector<std::uint8_t> left_;
  std::vector<std::int32_t> scratch_;
  Column<BvhTree::Node> nodes_;
  std::atomic<std::int32_t> next_node_{0};
};

}  // namespace

BoxTree sweep_sah(std::span<const Aabb> boxes, const SahParams& params) { return SweepSah(boxes, params).build(); }

BvhTree build_sweep_sah(const Scene& scene, const SahParams& params, int threads) {
  return on_threads(threads, [&] {
    const std::vector<BuildPrim> prims = build_prims(scene);
    std::vector<Aabb> boxes(prims.size());
    for (std::size_t i = 0; i < prims.size(); ++i) boxes[i] = prims[i].box;
    BoxTree over_boxes = sweep_sah(boxes, params);
    BvhTree tree{std::move(over_boxes.nodes), {}};
    for (const std::int32_t i : over_boxes.order) tree.order.push_back(prims[static_cast<std::size_t>(i)].ref);
    return depth_first(tree);
  });
}

}  // namespace raymeter
