// SBVH: Stich, Friedrich & Dietrich 2009, "Spatial splits in bounding volume hierarchies" (HPG). Top-down; beside the best split of the references by their
// centres a node considers planes that cut references in two, where the children of the former overlap by more than `split_overlap` of the root's area. A
// reference that a plane meets goes to both sides, each with the box of its part, or to one side whole where that costs less ("reference unsplitting").
//
// Departures: splits by centres are binned as spatial ones are (the paper sweeps over all of them), and the extra references are bounded by a share of the
// primitives that each node hands down to its children in proportion to what they hold, so that the tree does not depend on the order in which nodes are split.
// A node's references are split in place where centres decide, and go to new arrays where a plane does.

#include <algorithm>
#include <atomic>
#include <span>
#include <vector>

#include <tbb/parallel_invoke.h>

#include "accel/bvh/binned_splits.h"
#include "accel/bvh/box_builders.h"
#include "accel/bvh/build_prims.h"
#include "accel/bvh/spatial_bins.h"
#include "core/base/column.h"
#include "core/base/threads.h"
#include "core/bounds/split_reference.h"

namespace raymeter {

namespace {

/// Seven planes an axis are as good as 31, and need few cuts: DESIGN.md has the figures.
constexpr int kPlaneBins = 8;

class Sbvh {
public:
  Sbvh(const Scene& scene, const SahParams& sah, const SbvhParams& params) : scene_(scene), sah_(sah), params_(params) {
    references_.resize_for_overwrite(static_cast<std::size_t>(scene.prim_count()));
    for_each_prim_that_can_be_hit(scene, [&](std::size_t i, PrimRef prim) { references_[i] = {tight_bounds(scene.pools(), prim), prim}; });
  }

  BvhTree build() {
    if (references_.empty()) return {};
    const auto budget = static_cast<std::size_t>(params_.split_budget * static_cast<double>(references_.size()));
    tree_.order.resize(references_.size() + budget);
    tree_.nodes.resize_for_overwrite(2 * tree_.order.size());  // of which few are
    const NodeBounds bounds = bounds_of(references_.span());
    root_area_ = half_area(bounds.box);
    next_node_ = 1;
    split(0, {{references_.data(), references_.size()}, bounds, budget, 0});
    return depth_first(tree_);
  }

private:
  /// What is to become a subtree.
  struct Item {
    std::span<BinnedBox> references;
    NodeBounds bounds;
    std::size_t budget;  ///< references that it may add
    int depth;
  };

  /// The references on both sides of a plane.
  struct Sides {
    std::vector<BinnedBox> left, right;
  };

  /// Splits a reference that the plane meets: on both sides, or whole on one, whichever keeps the children cheapest; these follow.
  void put_to_cheapest(const BinnedBox& reference, const CutReference& cut, BinnedSide& left, BinnedSide& right, Sides& out) const {
    const auto cost = [](const Box4& a, std::int32_t a_count, const Box4& b, std::int32_t b_count) {
      return half_area(a) * static_cast<float>(a_count) + half_area(b) * static_cast<float>(b_count);
    };
    Box4 left_whole = left.box, right_whole = right.box;
    grow(left_whole, reference.box);
    grow(right_whole, reference.box);
    const float both = cost(left.box, left.count, right.box, right.count);
    const float in_left = cut.right.empty() ? -kInfinite : cost(left_whole, left.count, right.box, right.count - 1);
    const float in_right = cut.left.empty() ? -kInfinite : cost(left.box, left.count - 1, right_whole, right.count);
    if (in_left < both && in_left <= in_right) {
      out.left.push_back(reference);
      left.box = left_whole;
      --right.count;
    } else if (in_right < both) {
      out.right.push_back(reference);
      right.box = right_whole;
      --left.count;
    } else {
      out.left.emplace_back(cut.left, reference.prim());
      out.right.emplace_back(cut.right, reference.prim());
    }
  }

  [[nodiscard]] Sides split_by_plane(std::span<const BinnedBox> references, const BinnedSplit& split, const SpatialMapping& mapping,
                                     std::pair<BinnedSide, BinnedSide> children) const {
    Sides out;
    out.left.reserve(static_cast<std::size_t>(children.first.count));
    out.right.reserve(static_cast<std::size_t>(children.second.count));
    for (const BinnedBox& reference : references) {
      const bool in_left = mapping.bin(reference.box.min[split.axis], split.axis) < split.bin;
      const bool in_right = mapping.bin(reference.box.max[split.axis], split.axis) >= split.bin;
      if (in_left && in_right) {
        const SplitReference whole{reference.aabb(), reference.prim()};
        put_to_cheapest(reference, cut(scene_.pools(), whole, split.axis, mapping.border(split.bin, split.axis)), children.first, children.second, out);
      } else {
        (in_left ? out.left : out.right).push_back(reference);
      }
    }
    return out;
  }

  /// The best split by a plane, or nothing where it costs `most` or more, or has used up the budget without gaining: that cannot go on for ever.
  [[nodiscard]] Sides best_planes(const Item& item, float most) const {
    const SpatialMapping mapping(item.bounds.box, bin_count(std::min(sah_.bins, kPlaneBins), item.references.size()));
    Bins bins;
    bins.clear(mapping.bins);
    bin_parts(scene_, item.references, mapping, bins);
    const BinnedSplit split = cheapest(bins, mapping.bins);
    if (!(split.cost < most)) return {};
    Sides out = split_by_plane(item.references, split, mapping, sides(bins, mapping.bins, split));
    const bool both = !out.left.empty() && !out.right.empty();
    return both && out.left.size() + out.right.size() <= item.references.size() + item.budget ? std::move(out) : Sides{};
  }

  /// The best split by centres, and the half area that its children have in common; of the root's where there is none.
  struct ObjectSplit {
    CenterSplit split;
    float overlap = kInfinite;
  };
  [[nodiscard]] static ObjectSplit best_by_centers(std::span<const BinnedBox> references, const BinMapping& mapping) {
    ObjectSplit found{split_by_centers(references, mapping)};
    if (found.split.axis < 0) return found;
    const Box4 &left = found.split.left.box, &right = found.split.right.box;
    const Box4 common{left.min > right.min ? left.min : right.min, left.max < right.max ? left.max : right.max};
    const bool meet = common.min[0] <= common.max[0] && common.min[1] <= common.max[1] && common.min[2] <= common.max[2];
    found.overlap = meet ? half_area(common) : 0.0f;
    return found;
  }

  void split(std::int32_t node, const Item& item) {
    const std::size_t count = item.references.size();
    if (count == 1) return make_leaf(node, item.references);
    const BinMapping mapping(item.bounds.centers2, bin_count(sah_.bins, count));
    const bool balance = item.depth >= kBalanceDepth;
    const ObjectSplit object = balance ? ObjectSplit{} : best_by_centers(item.references, mapping);
    // A leaf, where it may be one, is a split too: others must cost less.
    const bool may_be_leaf = count <= static_cast<std::size_t>(sah_.max_leaf_size);
    const float area = half_area(item.bounds.box);
    const float leaf = may_be_leaf ? area * static_cast<float>(count) - static_cast<float>(sah_.node_cost) * area : kInfinite;
    Sides planes;
    if (!balance && item.budget > 0 && double{object.overlap} > params_.split_overlap * double{root_area_})
      planes = best_planes(item, std::min(object.split.cost, leaf));
    if (!planes.left.empty()) return split_into(node, item, planes.left, planes.right, bounds_of(planes.left), bounds_of(planes.right));
    if (!(object.split.cost < leaf) && may_be_leaf) return make_leaf(node, item.references);
    const Halves halves = partition(item.references, object.split, mapping);
    split_into(node, item, item.references.first(halves.left_count), item.references.subspan(halves.left_count), halves.left, halves.right);
  }

  void split_into(std::int32_t node, const Item& item, std::span<BinnedBox> left, std::span<BinnedBox> right, const NodeBounds& left_bounds,
                  const NodeBounds& right_bounds) {
    const std::size_t both = left.size() + right.size(), rest = item.budget - (both - item.references.size());
    const std::size_t left_budget = rest * left.size() / both;
    const std::int32_t child = next_node_.fetch_add(2);
    tree_.node(node) = {{}, child, 2, 0};
    const auto make_left = [&] { split(child, {left, left_bounds, left_budget, item.depth + 1}); };
    const auto make_right = [&] { split(child + 1, {right, right_bounds, rest - left_budget, item.depth + 1}); };
    if (both >= kParallelBoxes) {
      tbb::parallel_invoke(make_left, make_right);
    } else {
      make_left();
      make_right();
    }
    tree_.node(node).box = tree_.node(child).box;
    tree_.node(node).box.grow(tree_.node(child + 1).box);
  }

  void make_leaf(std::int32_t node, std::span<const BinnedBox> references) {
    const auto count = static_cast<std::int32_t>(references.size());
    BvhTree::Node leaf{{}, next_reference_.fetch_add(count), 0, count};
    for (std::size_t i = 0; i < references.size(); ++i) {
      const PrimRef ref = references[i].prim();
      tree_.order[static_cast<std::size_t>(leaf.first) + i] = ref;
      leaf.box.grow(padded_part(scene_.pools(), {references[i].aabb(), ref}));
    }
    tree_.node(node) = leaf;
  }

  const Scene& scene_;
  SahParams sah_;
  SbvhParams params_;
  Column<BinnedBox> references_;
  float root_area_ = 0;
  BvhTree tree_;
  std::atomic<std::int32_t> next_node_{0};
  std::atomic<std::int32_t> next_reference_{0};
};

}  // namespace

BvhTree build_sbvh(const Scene& scene, const SahParams& sah, const SbvhParams& params, int threads) {
  return on_threads(threads, [&] { return Sbvh(scene, sah, params).build(); });
}

}  // namespace raymeter
