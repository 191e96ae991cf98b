#pragma once

#include "accel/bvh/wide_tree.h"

namespace raymeter {

/// A wide hierarchy in the form that builders hand over, for what measures trees (tree_quality.h): the same nodes, boxes and leaves.
[[nodiscard]] BvhTree plain_tree(const Scene& scene, const WideTree& wide);

}  // namespace raymeter
