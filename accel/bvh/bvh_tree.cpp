#include "accel/bvh/bvh_tree.h"

#include <algorithm>

namespace raymeter {

BvhTree depth_first(const BvhTree& tree) {
  BvhTree out;
  if (tree.nodes.empty()) return out;
  out.nodes.reserve(tree.nodes.size());
  out.order.reserve(tree.order.size());
  out.nodes.push_back(tree.node(0));
  std::vector<std::int32_t> open{0};  // in `out`; their `first` still counts in `tree`
  while (!open.empty()) {
    const std::int32_t n = open.back();
    open.pop_back();
    const std::int32_t first = out.node(n).first;
    if (const std::int32_t children = out.node(n).child_count; children > 0) {
      out.node(n).first = static_cast<std::int32_t>(out.nodes.size());
      for (std::int32_t c = 0; c < children; ++c) out.nodes.push_back(tree.node(first + c));
      for (std::int32_t c = children - 1; c >= 0; --c) open.push_back(out.node(n).first + c);
      continue;
    }
    out.node(n).first = static_cast<std::int32_t>(out.order.size());
    const auto begin = tree.order.begin() + first;
    const auto leaf = out.order.insert(out.order.end(), begin, begin + out.node(n).prim_count);
    std::sort(leaf, out.order.end(), [](PrimRef p, PrimRef q) { return p.kind_bits != q.kind_bits ? p.kind_bits < q.kind_bits : p.index < q.index; });
  }
  return out;
}

BuildStats tree_stats(const BvhTree& tree) {
  BuildStats stats;
  if (tree.nodes.empty()) {
    stats.max_depth = 0;
    stats.sah_cost = 0;
    return stats;
  }
  struct Item {
    std::int32_t node;
    std::int32_t depth;
  };
  std::vector<Item> open{{0, 0}};
  std::int64_t max_depth = 0;
  double cost_sum = 0;
  while (!open.empty()) {
    const Item item = open.back();
    open.pop_back();
    const BvhTree::Node& node = tree.nodes[static_cast<std::size_t>(item.node)];
    cost_sum += double{node.box.half_area()} * sah_node_cost(node);
    max_depth = std::max<std::int64_t>(max_depth, item.depth);
    if (node.child_count == 0) {
      ++stats.leaves;
      stats.references += node.prim_count;
      continue;
    }
    ++stats.interior_nodes;
    for (std::int32_t c = node.first; c < node.first + node.child_count; ++c) open.push_back({c, item.depth + 1});
  }
  const double root_area = double{tree.nodes[0].box.half_area()};
  stats.max_depth = max_depth;
  if (root_area > 0) stats.sah_cost = cost_sum / root_area;
  return stats;
}

}  // namespace raymeter
