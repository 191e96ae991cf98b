// Wide nodes out of binary ones by taking in the child of largest area, the one whose own visit is the most likely, as long as there is room (Wald, Benthin &
// Boulos 2008, "Getting rid of packets"; Dammertz, Hanika & Keller 2008); and before that, narrow nodes out of wide ones by full-sweep SAH over the children.

#include "accel/bvh/collapse.h"

#include "accel/bvh/sweep_sah.h"
#include "core/base/threads.h"

namespace raymeter {

namespace {

/// Makes binary trees over the children of every node that has more than `width`.
void group_children(BvhTree& tree, int width) {
  for (auto n = static_cast<std::int32_t>(tree.nodes.size()); n-- > 0;) {  // children first, since they are copied
    const BvhTree::Node node = tree.node(n);
    if (node.child_count <= width) continue;
    std::vector<Aabb> boxes;
    for (std::int32_t c = 0; c < node.child_count; ++c) boxes.push_back(tree.node(node.first + c).box);
    SahParams one_a_leaf;
    one_a_leaf.max_leaf_size = 1;
    const BoxTree groups = sweep_sah(boxes, one_a_leaf);
    const auto base = static_cast<std::int32_t>(tree.nodes.size());
    for (BvhTree::Node group : groups.nodes) {
      if (group.child_count > 0)
        group.first += base;
      else
        group = tree.node(node.first + groups.order[static_cast<std::size_t>(group.first)]);
      tree.nodes.push_back(group);
    }
    tree.node(n) = tree.node(base);
  }
}

/// The children that a node gets: its own, those of the largest opened in their stead.
std::vector<std::int32_t> opened_children(const BvhTree& tree, const BvhTree::Node& node, int width) {
  std::vector<std::int32_t> children;
  for (std::int32_t c = 0; c < node.child_count; ++c) children.push_back(node.first + c);
  while (true) {
    auto largest = children.end();
    for (auto c = children.begin(); c != children.end(); ++c) {
      const BvhTree::Node& child = tree.node(*c);
      const bool fits = child.child_count > 0 && static_cast<int>(children.size()) - 1 + child.child_count <= width;
      if (fits && (largest == children.end() || child.box.half_area() > tree.node(*largest).box.half_area())) largest = c;
    }
    if (largest == children.end()) return children;
    const BvhTree::Node& opened = tree.node(*largest);
    *largest = opened.first;
    for (std::int32_t c = 1; c < opened.child_count; ++c) children.push_back(opened.first + c);
  }
}

}  // namespace

BvhTree with_width(const BvhTree& tree, int width, int threads) {
  if (tree.nodes.empty()) return tree;
  BvhTree narrow = tree;
  on_threads(threads, [&] { group_children(narrow, width); });
  BvhTree wide{{}, narrow.order};
  wide.nodes.push_back(narrow.nodes[0]);
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(wide.nodes.size()); ++n) {  // nodes from n on still hold their children in `narrow`
    if (wide.node(n).child_count == 0) continue;
    const std::vector<std::int32_t> children = opened_children(narrow, wide.node(n), width);
    wide.node(n).first = static_cast<std::int32_t>(wide.nodes.size());
    wide.node(n).child_count = static_cast<std::int32_t>(children.size());
    for (const std::int32_t c : children) wide.nodes.push_back(narrow.node(c));
  }
  return depth_first(wide);
}

}  // namespace raymeter
