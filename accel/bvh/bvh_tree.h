#pragma once

#include <cstdint>
#include <vector>

#include "accel/technique.h"
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
  std::vector<Node> nodes;     ///< nodes[0] is the root; empty for an empty scene
  std::vector<PrimRef> order;  ///< primitives as the leaves hold them
};

/// Top-down, splits by the surface area heuristic over binned centroids (Wald 2007), in parallel; the tree does not depend on `threads`.
struct BinnedSahSettings {
  int bins = 32;
  int max_leaf_size = 8;
  float node_cost = 1;
};
[[nodiscard]] BvhTree build_binned_sah(const Scene& scene, const BinnedSahSettings& settings, int threads);

/// Nodes, leaves, references, depth and SAH cost (C_t = C_i = 1) of a tree.
[[nodiscard]] BuildStats tree_stats(const BvhTree& tree);

}  // namespace raymeter
