#pragma once

#include <vector>

#include "accel/bvh/bvh_tree.h"
#include "accel/bvh/wide_layout.h"
#include "core/base/column.h"

namespace raymeter {

/// Costs of an 8-wide hierarchy, in visits of a node.
struct WideTreeSettings {
  float block_cost = 1.4f;    ///< of a triangle block
  float sphere_cost = 0.05f;  ///< of a leaf's sphere, besides 1 for the leaf: streams have them in lanes
  float prim_cost = 0.7f;     ///< likewise, of a polygon or cone
  int max_leaf_size = 8;      ///< primitives of another kind in a leaf
};

/// An 8-wide hierarchy as its traversal wants it.
struct WideTree {
  Column<WideNode> nodes;  ///< never empty: node 0 is the root
  Column<TriangleBlock> blocks;
  std::vector<PrimitiveRun> runs;
  std::vector<PrimRef> order;  ///< primitives that are no triangles, as the runs hold them
  std::int32_t stack_capacity = kWideChildren;
  BuildStats stats;
};

/// Collapses a hierarchy of at most two children a node into nodes of up to eight children and leaves of one kind, by dynamic programming over the surface area
/// heuristic: of all ways to cut the tree into wide nodes and leaves the cheapest (Ylitie, Karras, Laine 2017, "Efficient incoherent ray traversal on GPUs
/// through compressed wide BVHs"). The same on any number of threads (0: all).
[[nodiscard]] WideTree collapse_wide(const Scene& scene, BvhTree tree, const WideTreeSettings& settings, int threads);

}  // namespace raymeter
