// Binned SAH after Wald 2007, "On fast construction of SAH-based bounding volume hierarchies". Nodes are split in place over one array of boxes, and subtrees
// are built in parallel.

#include <algorithm>
#include <atomic>

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include "accel/bvh/binned_splits.h"
#include "accel/bvh/box_builders.h"
#include "accel/bvh/build_prims.h"
#include "core/base/column.h"
#include "core/base/threads.h"

namespace raymeter {

namespace {

class BinnedSah {
public:
  BinnedSah(const Scene& scene, const SahParams& params) : scene_(scene), params_(params), node_cost_(static_cast<float>(params.node_cost)) {}

  BvhTree build() {
    collect();
    BvhTree tree;
    if (boxes_.empty()) return tree;
    nodes_.resize_for_overwrite(2 * boxes_.size());  // of which few are
    next_node_ = 1;
    const std::span<BinnedBox> all(boxes_.data(), boxes_.size());
    split(0, all, bounds_of(all), 0);
    tree.nodes.assign(nodes_.begin(), nodes_.begin() + next_node_);
    tree.order.resize(boxes_.size());
    tbb::parallel_for(std::size_t{0}, boxes_.size(), [&](std::size_t i) { tree.order[i] = scene_.prim(boxes_[i].prim()); });
    return tree;
  }

private:
  void collect() {
    std::vector<std::int32_t> ids;
    ids.reserve(static_cast<std::size_t>(scene_.prim_count()));
    for (std::int32_t id = 0; id < scene_.prim_id_count(); ++id) {
      if (!scene_.prim(id).dropped()) ids.push_back(id);
    }
    boxes_.resize_for_overwrite(ids.size());
    tbb::parallel_for(std::size_t{0}, ids.size(), [&](std::size_t i) { boxes_[i] = {padded_bounds(scene_.pools(), scene_.prim(ids[i])), ids[i]}; });
  }

  [[nodiscard]] BinnedSplit best_split(std::span<const BinnedBox> boxes, const BinMapping& mapping) const {
    Bins bins(mapping.bins);
    bin_centers(boxes, mapping, bins);
    return cheapest(bins, mapping.bins);
  }

  void split(std::int32_t node, std::span<BinnedBox> boxes, const NodeBounds& bounds, int depth) {
    BvhTree::Node& made = nodes_[static_cast<std::size_t>(node)];
    made = {to_aabb(bounds.box)};
    const std::size_t count = boxes.size();
    const BinMapping mapping(bounds.centers2, bin_count(params_.bins, count));
    const BinnedSplit best = count > 1 && depth < kBalanceDepth ? best_split(boxes, mapping) : BinnedSplit{};
    const float area = half_area(bounds.box);
    const bool worth_it = node_cost_ * area + best.cost < static_cast<float>(count) * area;
    if (count == 1 || (count <= static_cast<std::size_t>(params_.max_leaf_size) && !worth_it)) return make_leaf(made, boxes);
    const Halves halves = partition(boxes, best, mapping);
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

  void make_leaf(BvhTree::Node& leaf, std::span<BinnedBox> boxes) {
    // By kind, then id: a leaf's runs, and the order of tests in it, follow from what it holds alone.
    std::sort(boxes.begin(), boxes.end(), [&](const BinnedBox& p, const BinnedBox& q) {
      const std::uint32_t p_kind = scene_.prim(p.prim()).kind_bits, q_kind = scene_.prim(q.prim()).kind_bits;
      return p_kind != q_kind ? p_kind < q_kind : p.prim() < q.prim();
    });
    leaf.first = static_cast<std::int32_t>(boxes.data() - boxes_.data());
    leaf.prim_count = static_cast<std::int32_t>(boxes.size());
  }

  const Scene& scene_;
  SahParams params_;
  float node_cost_;
  Column<BinnedBox> boxes_;
  Column<BvhTree::Node> nodes_;
  std::atomic<std::int32_t> next_node_{0};
};

}  // namespace

BvhTree build_binned_sah(const Scene& scene, const SahParams& params, int threads) {
  return on_threads(threads, [&] { return BinnedSah(scene, params).build(); });
}

}  // namespace raymeter
