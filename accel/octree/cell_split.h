#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "accel/octree/octree.h"
#include "core/bounds/aabb.h"

namespace raymeter {

enum class OctreeSplit : std::uint8_t { center, cost };
/// What stands for the objects' median: of an even number the upper one of the two in the middle, or their mean; or the mean of all.
enum class ObjectMedian : std::uint8_t { upper, mean_of_two, mean_of_all };

/// How cells are divided, by `split`:
///   center  in the middle
///   cost    of `planes`, evenly between the middle and the objects' median, the one with the least of (area below) (objects below) + (area above) (objects
///           above): MacDonald, Booth 1990, whose plane of least cost lies between the two medians
/// What published tables leave open of `cost`:
struct SplitRule {
  OctreeSplit split = OctreeSplit::center;
  int planes = 10;
  bool ends = false;  ///< the middle and the median are two of the planes, instead of none
  ObjectMedian median = ObjectMedian::upper;
  bool whole_boxes = false;    ///< the median is of the centres of the boxes, instead of those of their parts in the cell
  bool length_cost = false;    ///< a side costs its length times its objects, instead of its area
  bool count_centers = false;  ///< an object is on the side of its box's centre, instead of on each that its box touches

  explicit SplitRule(const OctreeParams& params);
};

struct CellToSplit {
  Aabb box;
  double least = 0;   ///< axes shorter than this are not divided
  double margin = 0;  ///< how far lists reach beyond cells, and so what is counted on a side of a plane beyond it
};

/// Where a cell is divided: a plane for each axis, infinite where it is not to be. `boxes` are all primitives' boxes, `in_cell` those that the cell lists.
[[nodiscard]] glm::vec3 split_point(const SplitRule& rule, const CellToSplit& cell, const std::vector<Aabb>& boxes, std::span<const std::uint32_t> in_cell);

}  // namespace raymeter
