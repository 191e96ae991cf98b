#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "accel/kdtree/kdtree.h"
#include "core/bounds/split_reference.h"

namespace raymeter {

/// A plane that halves a cell, and where the references go that lie in it.
struct KdPlane {
  int axis = -1;  ///< -1: none, the cell stays whole
  float position = 0;
  bool flat_below = true;
};

/// The plane for a cell at some depth that holds these references; their boxes are inside the cell.
using KdPlaneChoice = std::function<KdPlane(std::span<const SplitReference> references, const Aabb& cell, int depth)>;

/// A built tree before it is laid out for traversal.
struct KdTopology {
  struct Node {
    int axis = -1;  ///< -1: a leaf
    float position = 0;
    std::int32_t link = 0;   ///< the upper child (the lower one stands next), of a leaf its first reference
    std::int32_t count = 0;  ///< of a leaf's references
  };
  std::vector<Node> nodes;  ///< depth first, lower child first
  std::vector<PrimRef> references;
  Aabb cell;  ///< of the root: the tight box of all primitives
};

/// Splits cells until `choose` finds no plane, `leaf_size` or `max_depth` (0: 8 + 1.3 log2 n) is reached, or references would exceed the budget, which is
/// handed down in proportion to what children hold. The same on any number of threads (0: all).
[[nodiscard]] KdTopology build_kd_topology(const Scene& scene, const KdParams& params, const KdPlaneChoice& choose, int threads);

/// The cheapest plane by the surface area heuristic: kd_build_sah.cpp.
[[nodiscard]] KdPlane cheapest_kd_plane(std::span<const SplitReference> references, const Aabb& cell, const KdTreeParams& params);
/// The middle of the cell, on the axes in turn; axes on which it cannot be halved are passed over.
[[nodiscard]] KdPlane median_kd_plane(const Aabb& cell, int depth) noexcept;

}  // namespace raymeter
