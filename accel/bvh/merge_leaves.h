#pragma once

#include "accel/bvh/bvh_params.h"
#include "accel/bvh/bvh_tree.h"

namespace raymeter {

/// The tree, depth first, with a leaf in place of every subtree of at most max_leaf_size primitives that costs no less by the surface area heuristic.
[[nodiscard]] BvhTree merge_leaves(const BvhTree& tree, const SahParams& params);

}  // namespace raymeter
