#include "accel/kdtree/kd_tree.h"

#include <algorithm>
#include <array>
#include <bit>

namespace raymeter {

namespace {

class Layout {
public:
  Layout(const Scene& scene, const KdTopology& topology) : scene_(scene), topology_(topology) {
    for (std::size_t k = 0; k < kPrimKindCount; ++k) position_[k].resize(scene.pools().size(static_cast<PrimKind>(k)), -1);
  }

  KdTree run() {
    const std::size_t count = topology_.nodes.size();
    if (count + 1 > KdNode::kMostLinks) throw Error("max_depth: the tree has " + std::to_string(count) + " nodes; expected less than 2^29");
    if (const std::size_t references = topology_.references.size(); references > std::size_t{std::numeric_limits<std::int32_t>::max()})
      throw Error("reference_budget: the tree has " + std::to_string(references) + " references; expected less than 2^31");
    tree_.nodes.resize(count + 1);
    tree_.refs.reserve(topology_.references.size());
    tree_.nodes[1] = leaf_node(KdNode::kRuns, 0, 0);
    place_nodes();
    tree_.pools = reordered(scene_.pools(), order_);
    for (const PrimRef ref : order_) {
      const Aabb tight = tight_bounds(scene_.pools(), ref);
      const glm::dvec3 extent = glm::dvec3(tight.max) - glm::dvec3(tight.min);
      tree_.box.grow(padded(tight));
      // No diameter is larger than the sum of the extents.
      tree_.largest_size = std::max(tree_.largest_size, static_cast<float>((extent.x + extent.y + extent.z) * (1 + 0x1p-20)));
    }
    return std::move(tree_);
  }

private:
  static KdNode leaf_node(std::uint32_t tag, std::size_t first, std::size_t count) {
    return {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count) << KdNode::kTagBits | tag};
  }

  /// Depth first, so that subtrees lie together; the children of a node are two places side by side.
  void place_nodes() {
    struct Item {
      std::size_t from, to;
      std::int32_t depth;
    };
    std::size_t next = 2;
    std::vector<Item> open{{0, 0, 0}};
    while (!open.empty()) {
      const Item item = open.back();
      open.pop_back();
      tree_.depth = std::max(tree_.depth, item.depth);
      const KdTopology::Node& node = topology_.nodes[item.from];
      if (node.axis < 0) {
        tree_.nodes[item.to] = placed_leaf(node);
        continue;
      }
      tree_.nodes[item.to] = {std::bit_cast<std::uint32_t>(node.position),
                              static_cast<std::uint32_t>(next) << KdNode::kTagBits | static_cast<std::uint32_t>(node.axis)};
      open.push_back({static_cast<std::size_t>(node.link), next + 1, item.depth + 1});
      open.push_back({item.from + 1, next, item.depth + 1});
      next += 2;
    }
  }

  KdNode placed_leaf(const KdTopology::Node& leaf) {
    const auto begin = topology_.references.begin() + leaf.link;
    std::vector<PrimRef> prims(begin, begin + leaf.count);
    std::stable_sort(prims.begin(), prims.end(), [](PrimRef a, PrimRef b) { return a.kind() < b.kind(); });
    const std::size_t first = tree_.refs.size(), first_run = tree_.runs.size();
    for (const PrimRef ref : prims) tree_.refs.push_back(position(ref));
    if (prims.empty()) return leaf_node(KdNode::kRuns, 0, 0);
    if (prims.front().kind() == prims.back().kind()) {
      return leaf_node(KdNode::kKind + static_cast<std::uint32_t>(prims.front().kind()), first, prims.size());
    }
    for (std::size_t i = 0; i < prims.size();) {
      std::size_t end = i;
      while (end < prims.size() && prims[end].kind() == prims[i].kind()) ++end;
      tree_.runs.push_back(primitive_run(prims[i].kind(), static_cast<std::int32_t>(first + i), static_cast<std::int32_t>(end - i)));
      i = end;
    }
    return leaf_node(KdNode::kRuns, first_run, tree_.runs.size() - first_run);
  }

  /// Where a primitive stands in its pool, the next free place where it has none yet.
  std::int32_t position(PrimRef ref) {
    const auto kind = static_cast<std::size_t>(ref.kind());
    std::int32_t& position = position_[kind][ref.index];
    if (position < 0) {
      position = placed_[kind]++;
      order_.push_back(ref);
    }
    return position;
  }

  const Scene& scene_;
  const KdTopology& topology_;
  KdTree tree_;
  std::array<std::vector<std::int32_t>, kPrimKindCount> position_;
  std::array<std::int32_t, kPrimKindCount> placed_{};
  std::vector<PrimRef> order_;
};

}  // namespace

KdView KdTree::view(bool frustum, bool mailbox) const noexcept {
  return {pools.view(), nodes.data(),     refs.data(), runs.data(), {box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z},
          largest_size, stack_capacity(), frustum,     mailbox};
}

std::size_t KdTree::mem_bytes() const noexcept { return sizeof *this + nodes.bytes() + refs.bytes() + runs.bytes() + pools.mem_bytes(); }

KdTree lay_out(const Scene& scene, const KdTopology& topology) { return Layout(scene, topology).run(); }

BuildStats kd_stats(const KdTopology& topology) {
  BuildStats stats;
  struct Item {
    std::size_t node;
    Aabb cell;
    std::int64_t depth;
  };
  std::int64_t depth = 0;
  double cost = 0;
  std::vector<Item> open{{0, topology.cell, 0}};
  while (!open.empty()) {
    const Item item = open.back();
    open.pop_back();
    const KdTopology::Node& node = topology.nodes[item.node];
    depth = std::max(depth, item.depth);
    const double area = double{item.cell.half_area()};
    if (node.axis < 0) {
      ++stats.leaves;
      stats.empty_leaves += node.count == 0 ? 1 : 0;
      stats.references += node.count;
      cost += area * node.count;
      continue;
    }
    ++stats.interior_nodes;
    cost += area;
    Aabb low = item.cell, high = item.cell;
    low.max[node.axis] = high.min[node.axis] = node.position;
    open.push_back({static_cast<std::size_t>(node.link), high, item.depth + 1});
    open.push_back({item.node + 1, low, item.depth + 1});
  }
  stats.max_depth = depth;
  if (topology.cell.half_area() > 0) stats.sah_cost = cost / double{topology.cell.half_area()};
  return stats;
}

}  // namespace raymeter
