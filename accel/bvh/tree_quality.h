#pragma once

#include "accel/bvh/bvh_tree.h"

namespace raymeter {

/// Adds to `stats` what takes more time to find than the tree's size: the lecture's criteria of a good hierarchy (Kay & Kajiya 1986, Goldsmith & Salmon 1987)
/// and end-point overlap (Aila et al. 2013). All refer to the boxes of the tree. Runs on at most `threads` threads (0: all), on whose number nothing depends.
void add_tree_quality(const Scene& scene, const BvhTree& tree, int threads, BuildStats& stats);

}  // namespace raymeter
