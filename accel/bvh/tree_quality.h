#pragma once

#include <span>

#include "accel/bvh/bvh_tree.h"

namespace raymeter {

/// Of a node's volume.
struct NodeMeasure {
  double half_area = 0;
  double enclosed = 0;
};

// Both add to a tree's figures what takes more time to find than its size: the criteria of a good hierarchy (Kay & Kajiya 1986, Goldsmith & Salmon 1987) and
// end-point overlap (Aila et al. 2013).

/// Those by the volumes in use, measures[n] being node n's: their area and volume, SAH cost, and how deep it lies.
void add_volume_quality(const BvhTree& tree, std::span<const NodeMeasure> measures, BuildStats& stats);
/// Those by the tree's boxes: nearness of siblings and end-point overlap. Runs on at most `threads` threads (0: all), on whose number nothing depends.
void add_box_quality(const Scene& scene, const BvhTree& tree, int threads, BuildStats& stats);

}  // namespace raymeter
