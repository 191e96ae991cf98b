#pragma once

#include <memory>

#include "accel/bvh/wide_tree.h"
#include "accel/technique.h"

namespace raymeter {

/// An 8-wide hierarchy whose nodes are quantised_nodes() of `bits`, and its traversals: streams and single rays. Throws Error as that does.
[[nodiscard]] std::unique_ptr<Structure> make_quantised_bvh(const Scene& scene, WideTree tree, int bits);

}  // namespace raymeter
