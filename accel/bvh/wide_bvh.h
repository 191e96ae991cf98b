#pragma once

#include "accel/bvh/bvh_tree.h"

namespace raymeter {

/// An 8-wide hierarchy with leaves of triangles that share vertices, made of `tree` and traversed by the beams of packets. `max_leaf_size`: of
/// primitives that are no triangles.
[[nodiscard]] std::unique_ptr<Structure> build_wide_bvh(const Scene& scene, BvhTree tree, int max_leaf_size, int threads);

}  // namespace raymeter
