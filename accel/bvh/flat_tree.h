#pragma once

#include <cstdint>
#include <vector>

#include "accel/bvh/bvh_tree.h"
#include "accel/volume_links_layout.h"

namespace raymeter {

/// A tree as traversals see it, but for the volumes: links in depth-first order of their parents, the children of a node together, and the primitives in the
/// order of the leaves.
struct FlatTree {
  /// Where a link comes from.
  struct Source {
    std::int32_t node = -1;       ///< in the tree; -1: the unused link 1
    std::int32_t first_prim = 0;  ///< what is below: [first_prim, end_prim) of `order`
    std::int32_t end_prim = 0;
  };
  std::vector<VolumeLink> links;  ///< link 0 is the root
  std::vector<Source> sources;    ///< of each link
  std::vector<PrimitiveRun> runs;
  std::vector<PrimRef> order;
  std::int32_t stack_capacity = 1;  ///< entries that a depth-first traversal needs: the sum of children - 1 along a path, and one
  std::int32_t heap_capacity = 1;   ///< nodes none of which is an ancestor of another: the leaves
};

[[nodiscard]] FlatTree flatten(const BvhTree& tree);

}  // namespace raymeter
