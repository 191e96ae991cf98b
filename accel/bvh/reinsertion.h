#pragma once

#include "accel/bvh/bvh_tree.h"

namespace raymeter {

/// Moves subtrees of a binary tree to where they cost least, in at most `passes` rounds over all nodes; the sum of the nodes' areas never grows. The result
/// does not depend on `threads` (0: all).
[[nodiscard]] BvhTree reinserted(const BvhTree& tree, int passes, int threads);

}  // namespace raymeter
