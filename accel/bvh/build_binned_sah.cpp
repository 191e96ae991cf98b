// Binned SAH after Wald 2007, "On fast construction of SAH-based bounding volume hierarchies". Nodes are split in place over one array of boxes, and subtrees
// are built in parallel.

#include <algorithm>
#include <array>
#include <atomic>

#include <tbb/parallel_invoke.h>

#include "accel/bvh/binned_splits.h"
#include "accel/bvh/box_builders.h"
#include "accel/bvh/build_prims.h"
#include "accel/bvh/triangle_block.h"
#include "core/base/column.h"
#include "core/base/threads.h"

namespace raymeter {

namespace {

class BinnedSah {
public:
  BinnedSah(const Scene& scene, const SahParams& params, LeafUse use)
      : scene_(scene), params_(params), node_cost_(static_cast<float>(params.node_cost)), use_(use) {}

  BvhTree build() {
    boxes_.resize_for_overwrite(static_cast<std::size_t>(scene_.prim_count()));
    for_each_prim_that_can_be_hit(scene_, [&](std::size_t i, PrimRef prim) { boxes_[i] = {padded_bounds(scene_.pools(), prim), prim}; });
    if (boxes_.empty()) return {};
    tree_.nodes.resize_for_overwrite(2 * boxes_.size());  // of which few are
    tree_.order.resize(boxes_.size());
    next_node_ = 1;
    const std::span<BinnedBox> all(boxes_.data(), boxes_.size());
    split(0, all, bounds_of(all), 0);
    tree_.nodes.resize_for_overwrite(static_cast<std::size_t>(next_node_));
    tree_.fits_blocks = use_ == LeafUse::for_blocks;
    return std::move(tree_);
  }

private:
  void split(std::int32_t node, std::span<BinnedBox> boxes, const NodeBounds& bounds, int depth) {
    BvhTree::Node& made = tree_.node(node);
    made = {to_aabb(bounds.box)};
    const std::size_t count = boxes.size();
    if (count == 1) return make_leaf(made, boxes);
    const BinMapping mapping(bounds.centers2, bin_count(params_.bins, count));
    const CenterSplit best = depth < kBalanceDepth ? split_by_centers(boxes, mapping) : CenterSplit{};
    const float area = half_area(bounds.box);
    const bool worth_it = node_cost_ * area + best.cost < static_cast<float>(count) * area;
    const bool for_block = use_ == LeafUse::for_blocks && all_triangles(boxes);
    if (!for_block && count <= static_cast<std::size_t>(params_.max_leaf_size) && !worth_it) return make_leaf(made, boxes);
    const Halves halves = partition(boxes, best, mapping);
    if (for_block && !(worth_it && half_area(halves.left.box) + half_area(halves.right.box) < area) && fits_block(boxes)) return make_leaf(made, boxes);
    const std::int32_t child = next_node_.fetch_add(2);
    made.first = child;
    made.child_count = 2;
    const auto left = [&] { split(child, boxes.first(halves.left_count), halves.left, depth + 1); };
    const auto right = [&] { split(child + 1, boxes.subspan(halves.left_count), halves.right, depth + 1); };
    if (count >= kParallelBoxes) {
      tbb::parallel_invoke(left, right);
    } else {
      left();
      right();
    }
  }

  /// Whether they are triangles, and no more than a block may hold.
  [[nodiscard]] static bool all_triangles(std::span<const BinnedBox> boxes) noexcept {
    return boxes.size() <= TriangleBlock::kTriangles &&
           std::ranges::all_of(boxes, [](const BinnedBox& box) { return box.prim().kind() == PrimKind::triangle; });
  }
  [[nodiscard]] bool fits_block(std::span<const BinnedBox> boxes) const noexcept {
    std::array<PrimRef, TriangleBlock::kTriangles> prims;
    std::ranges::transform(boxes, prims.begin(), &BinnedBox::prim);
    return fits_leaf(scene_.pools(), std::span(prims).first(boxes.size()), 0);
  }

  /// By kind, then index: a leaf's runs, and the order of tests in it, follow from what it holds alone.
  void make_leaf(BvhTree::Node& leaf, std::span<const BinnedBox> boxes) {
    leaf.first = static_cast<std::int32_t>(boxes.data() - boxes_.data());
    leaf.prim_count = static_cast<std::int32_t>(boxes.size());
    const auto begin = tree_.order.begin() + leaf.first;
    std::ranges::transform(boxes, begin, &BinnedBox::prim);
    std::sort(begin, begin + leaf.prim_count, [](PrimRef p, PrimRef q) { return p.kind_bits != q.kind_bits ? p.kind_bits < q.kind_bits : p.index < q.index; });
  }

  const Scene& scene_;
  SahParams params_;
  float node_cost_;
  LeafUse use_;
  Column<BinnedBox> boxes_;
  BvhTree tree_;
  std::atomic<std::int32_t> next_node_{0};
};

}  // namespace

BvhTree build_binned_sah(const Scene& scene, const SahParams& params, int threads, LeafUse use) {
  return on_threads(threads, [&] { return BinnedSah(scene, params, use).build(); });
}

}  // namespace raymeter
