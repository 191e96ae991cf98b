#pragma once

#include "accel/bvh/bvh_tree.h"
#include "accel/bvh/wide_tree.h"

namespace raymeter {

/// An 8-wide hierarchy with leaves of triangles that share vertices, made of a tree of any width. `max_leaf_size`: of primitives that are no triangles.
[[nodiscard]] WideTree make_wide_tree(const Scene& scene, BvhTree tree, int max_leaf_size, int threads);

/// The same with its traversals: beams, streams, and what suits a slice of the two.
[[nodiscard]] std::unique_ptr<Structure> build_wide_bvh(const Scene& scene, BvhTree tree, int max_leaf_size, int threads);

}  // namespace raymeter
