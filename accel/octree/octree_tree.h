#pragma once

#include <vector>

#include "accel/octree/octree.h"
#include "accel/octree/octree_layout.h"
#include "core/base/column.h"
#include "core/scene/pools.h"

namespace raymeter {

/// A built octree: see OctreeView for what the columns hold.
struct Octree {
  std::array<float, 6> box{};
  std::array<float, 3> center{};
  float reach = 0;
  double margin = 0;  ///< how far beyond a cell its list reaches
  bool exact = false;
  std::int32_t root = ~0;
  std::vector<PrimKind> kinds;  ///< that the scene has
  Pools pools;                  ///< the scene's primitives in the order of the first leaf that lists them
  Column<OctreeNode> nodes;     ///< depth first
  Column<float> outline;
  Column<std::int32_t> first;
  Column<std::int32_t> refs;  ///< in the order of the pools within a leaf and kind
  BuildStats stats;

  [[nodiscard]] OctreeView view(const OctreeParams& params) const noexcept;
};

/// The same tree on any number of threads (0: all).
[[nodiscard]] Octree build_octree_tree(const Scene& scene, const OctreeParams& params, int threads);

}  // namespace raymeter
