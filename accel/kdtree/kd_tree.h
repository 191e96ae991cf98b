#pragma once

#include <vector>

#include "accel/kdtree/kd_layout.h"
#include "accel/kdtree/kd_topology.h"
#include "accel/technique.h"
#include "core/base/column.h"
#include "core/scene/pools.h"

namespace raymeter {

/// A k-d tree as kernels see it: see KdView for what the columns hold.
struct KdTree {
  Column<KdNode> nodes;
  Column<std::int32_t> refs;
  Column<PrimitiveRun> runs;
  Pools pools;  ///< in the order of the first leaf that lists a primitive
  Aabb box;     ///< around the padded boxes of all primitives
  float largest_size = 0;
  std::int32_t depth = 0;

  [[nodiscard]] KdView view(bool frustum, bool mailbox) const noexcept;
  [[nodiscard]] std::int32_t stack_capacity() const noexcept { return depth + 1; }
  [[nodiscard]] std::size_t mem_bytes() const noexcept;
};

[[nodiscard]] KdTree lay_out(const Scene& scene, const KdTopology& topology);
/// Counts of nodes and references, depth and cost; the cost is that of a random line that meets the root's cell.
[[nodiscard]] BuildStats kd_stats(const KdTopology& topology);

}  // namespace raymeter
