#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "accel/bvh/bvh_params.h"
#include "accel/bvh/bvh_tree.h"

namespace raymeter {

/// A hierarchy over boxes, whatever they hold.
struct BoxTree {
  Column<BvhTree::Node> nodes;      ///< as in BvhTree, `first` of a leaf being a position in `order`
  std::vector<std::int32_t> order;  ///< indices of boxes
};

/// Top-down and binary, every split between sorted centres weighed by the surface area heuristic. Runs in the caller's task arena; the tree does not depend on
/// it but for the numbering of nodes.
[[nodiscard]] BoxTree sweep_sah(std::span<const Aabb> boxes, const SahParams& params);

}  // namespace raymeter
