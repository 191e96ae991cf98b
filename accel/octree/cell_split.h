#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "accel/octree/octree.h"
#include "core/bounds/aabb.h"

namespace raymeter {

enum class OctreeSplit : std::uint8_t { center, cost };

/// How cells are divided, by `split`:
///   center  in the middle
///   cost    of `planes`, evenly between the middle and the objects' median, the one with the least of (area below) (objects below) + (area above) (objects
///           above): MacDonald, Booth 1990, whose plane of least cost lies between the two medians
/// What published tables leave open of `cost`:
struct SplitRule {
  OctreeSplit split = OctreeSplit::center;
  int planes = 10;
  bool ends = false;           ///< the middle and the median are two of the planes, instead of none
  bool whole_boxes = false;    ///< the median is of the centres of the boxes, instead of those of their parts in the cell
  bool mean_median = false;    ///< of an even number the median is the mean of the two in the middle, instead of the upper one
  bool length_cost = false;    ///< a side costs its length times its objects, instead of its area
  bool count_centers = false;  ///< an object is on the side of its box's centre, instead of on each that its box touches

  explicit SplitRule(const OctreeParams& params);
};

/// Where a cell is divided: a plane for each axis, infinite where it is not to be. Axes shorter than `least` are not divided. `boxes` are all primitives'
/// boxes, `in_cell` those that the cell lists.
[[nodiscard]] glm::vec3 split_point(const SplitRule& rule, const Aabb& cell, double least, const std::vector<Aabb>& boxes,
                                    std::span<const std::uint32_t> in_cell);

}  // namespace raymeter
