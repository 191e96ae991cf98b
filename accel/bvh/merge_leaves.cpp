#include "accel/bvh/merge_leaves.h"

namespace raymeter {

BvhTree merge_leaves(const BvhTree& tree, const SahParams& params) {
  BvhTree out = depth_first(tree);
  struct Subtree {
    double cost;
    std::int32_t first;  ///< of its primitives, which depth-first order has brought together
    std::int32_t count;
  };
  std::vector<Subtree> subtrees(out.nodes.size());
  for (auto n = static_cast<std::int32_t>(out.nodes.size()); n-- > 0;) {  // children before their parent
    BvhTree::Node& node = out.node(n);
    Subtree& subtree = subtrees[static_cast<std::size_t>(n)];
    const double area = double{node.box.half_area()};
    if (node.child_count == 0) {
      subtree = {area * node.prim_count, node.first, node.prim_count};
      continue;
    }
    subtree = {params.node_cost * area, subtrees[static_cast<std::size_t>(node.first)].first, 0};
    for (std::int32_t c = node.first; c < node.first + node.child_count; ++c) {
      subtree.cost += subtrees[static_cast<std::size_t>(c)].cost;
      subtree.count += subtrees[static_cast<std::size_t>(c)].count;
    }
    if (subtree.count > params.max_leaf_size || subtree.cost < area * subtree.count) continue;
    subtree.cost = area * subtree.count;
    node = {node.box, subtree.first, 0, subtree.count};
  }
  return depth_first(out);
}

}  // namespace raymeter
