#pragma once

#include <span>
#include <vector>

#include "accel/octree/octree_tree.h"
#include "core/bounds/aabb.h"

namespace raymeter {

/// A tree as the builder makes it, level by level: the columns of an Octree, but numbered in the order in which things came.
struct OctreeDraft {
  struct Node {
    glm::vec3 split;
    Aabb box;
    std::int32_t child[8] = {~0, ~0, ~0, ~0, ~0, ~0, ~0, ~0};
  };
  std::vector<PrimRef> entries;  ///< all primitives, by kind
  std::vector<Node> nodes;
  std::vector<std::size_t> leaf_end{0};  ///< per leaf, the empty one first: the end of its list
  std::vector<std::uint32_t> refs;       ///< entries
  std::int32_t root = ~0;

  std::int32_t add_node(std::int32_t parent, int child, const glm::vec3& split, const Aabb& box);
  void add_leaf(std::int32_t parent, int child, std::span<const std::uint32_t> list);

private:
  void attach(std::int32_t parent, int child, std::int32_t link) noexcept;
};

/// Fills the tree's nodes, lists, pools and figures, everything in depth-first order.
void flatten(const Pools& pools, const OctreeDraft& draft, Octree& tree);

}  // namespace raymeter
