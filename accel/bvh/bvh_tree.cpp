#include "accel/bvh/bvh_tree.h"

#include <algorithm>

namespace raymeter {

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
  double area_sum = 0;  // of what a ray tests: children once a node is opened, primitives once a leaf is
  while (!open.empty()) {
    const Item item = open.back();
    open.pop_back();
    const BvhTree::Node& node = tree.nodes[static_cast<std::size_t>(item.node)];
    const double area = double{node.box.half_area()};
    max_depth = std::max<std::int64_t>(max_depth, item.depth);
    if (node.child_count == 0) {
      ++stats.leaves;
      stats.references += node.prim_count;
      area_sum += area * node.prim_count;
      continue;
    }
    ++stats.interior_nodes;
    area_sum += area;
    for (std::int32_t c = node.first; c < node.first + node.child_count; ++c) open.push_back({c, item.depth + 1});
  }
  const double root_area = double{tree.nodes[0].box.half_area()};
  stats.max_depth = max_depth;
  if (root_area > 0) stats.sah_cost = area_sum / root_area;
  return stats;
}

}  // namespace raymeter
