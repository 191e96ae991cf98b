#pragma once

#include "accel/bvh/bvh_tree.h"

namespace raymeter {

/// The tree with at most `width` >= 2 children a node: children of nodes that have more are grouped by the surface area heuristic, and then nodes take in their
/// children's children, the child of largest area first, while there is room.
[[nodiscard]] BvhTree with_width(const BvhTree& tree, int width, int threads);

}  // namespace raymeter
