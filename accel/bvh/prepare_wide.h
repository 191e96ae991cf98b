#pragma once

#include "accel/bvh/bvh_tree.h"

namespace raymeter {

/// Replaces single children by what they hold, and splits leaves until each fits a leaf of a wide tree (triangle_block.h).
void prepare_wide(const Scene& scene, BvhTree& tree, int max_leaf_size);

}  // namespace raymeter
