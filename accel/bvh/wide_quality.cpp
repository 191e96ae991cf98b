#include "accel/bvh/wide_quality.h"

#include <span>

namespace raymeter {

namespace {

/// Where each run's primitives begin in the tree's order.
std::vector<std::int32_t> run_begins(const WideTree& wide) {
  std::vector<std::int32_t> begins;
  std::int32_t next = 0;
  for (const PrimitiveRun& run : wide.runs) {
    begins.push_back(next);
    next += run.count();
  }
  return begins;
}

void append_prims(const Scene& scene, const WideTree& wide, std::span<const std::int32_t> run_begin, WideRef leaf, std::vector<PrimRef>& prims) {
  if (leaf.tag() == WideRef::Tag::block) {
    const TriangleBlock& block = wide.blocks[leaf.index()];
    for (std::int32_t t = 0; t < block.count; ++t) prims.push_back(scene.prim(block.prim[t]));
  } else {
    const auto begin = wide.order.begin() + run_begin[leaf.index()];
    prims.insert(prims.end(), begin, begin + wide.runs[leaf.index()].count());
  }
}

Aabb box_of(const WideNode& node, int place) {
  return {{node.plane[0][place], node.plane[1][place], node.plane[2][place]}, {node.plane[3][place], node.plane[4][place], node.plane[5][place]}};
}

}  // namespace

BvhTree plain_tree(const Scene& scene, const WideTree& wide) {
  const std::vector<std::int32_t> run_begin = run_begins(wide);
  BvhTree tree;
  tree.nodes.resize(1);
  std::vector<std::uint32_t> source{0};  // inner nodes: which wide one
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(tree.nodes.size()); ++n) {
    if (tree.node(n).prim_count > 0) continue;
    const WideNode& node = wide.nodes[source[static_cast<std::size_t>(n)]];
    tree.node(n).first = static_cast<std::int32_t>(tree.nodes.size());
    for (int place = 0; place < kWideChildren; ++place) {
      if (!(node.plane[0][place] <= node.plane[3][place])) continue;  // nothing there
      const WideRef ref = node.child[place];
      BvhTree::Node child;
      child.box = box_of(node, place);
      if (n == 0) tree.node(0).box.grow(child.box);
      if (ref.tag() != WideRef::Tag::inner) {
        child.first = static_cast<std::int32_t>(tree.order.size());
        append_prims(scene, wide, run_begin, ref, tree.order);
        child.prim_count = static_cast<std::int32_t>(tree.order.size()) - child.first;
      }
      ++tree.node(n).child_count;
      tree.nodes.push_back(child);
      source.push_back(ref.index());
    }
  }
  if (tree.node(0).child_count == 0) return {};
  return depth_first(tree);
}

}  // namespace raymeter
