#pragma once

#include <cstdint>
#include <vector>

#include "accel/technique.h"
#include "core/base/column.h"
#include "core/bounds/aabb.h"

namespace raymeter {

/// What builders make: the topology of a hierarchy over the scene's primitives, before it is laid out for a traversal.
struct BvhTree {
  struct Node {
    Aabb box;
    std::int32_t first = 0;        ///< inner: index of its first child; leaf: position of its first primitive in `order`
    std::int32_t child_count = 0;  ///< children are consecutive; 0: a leaf
    std::int32_t prim_count = 0;   ///< leaves only
  };
  Column<Node> nodes;          ///< nodes[0] is the root, children come after their parent; empty for an empty scene
  std::vector<PrimRef> order;  ///< primitives as the leaves hold them; those that spatial splits cut occur more than once
  bool fits_blocks = false;    ///< leaves of triangles alone are known to fit those of a wide tree (triangle_block.h); they are sorted by kind

  [[nodiscard]] Node& node(std::int32_t n) noexcept { return nodes[static_cast<std::size_t>(n)]; }
  [[nodiscard]] const Node& node(std::int32_t n) const noexcept { return nodes[static_cast<std::size_t>(n)]; }
};

/// The same tree with its nodes in depth-first order (children together), its primitives in the order of the leaves, each leaf's by kind, then index; nodes
/// that nothing refers to are left out. `tree` need not keep children after their parent. Two trees that are the same but for the numbering of nodes become
/// equal.
[[nodiscard]] BvhTree depth_first(const BvhTree& tree);

/// What the surface area heuristic with C_t = C_i = 1 takes a node for, once a ray meets it: half a test for each child's volume, so that a binary node costs
/// C_t, and one for each primitive of a leaf.
[[nodiscard]] inline double sah_node_cost(const BvhTree::Node& node) noexcept { return node.child_count > 0 ? 0.5 * node.child_count : node.prim_count; }

/// Nodes, leaves, references, depth and SAH cost of a tree, by its boxes.
[[nodiscard]] BuildStats tree_stats(const BvhTree& tree);

}  // namespace raymeter
