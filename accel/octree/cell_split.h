#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "accel/octree/octree.h"
#include "core/bounds/aabb.h"

namespace raymeter {

enum class OctreeSplit : std::uint8_t { center, cost };

/// Where a cell is divided: a plane for each axis, infinite where it is not to be. Axes shorter than `least` are not divided.
///   center  in the middle
///   cost    of ten planes, evenly between the middle and the objects' median, the one with the least of (area below) (boxes below) + (area above) (boxes
///   above):
///           MacDonald, Booth 1990, whose plane of least cost lies between the two medians
/// `boxes` are all primitives' boxes, `in_cell` those that the cell lists.
[[nodiscard]] glm::vec3 split_point(OctreeSplit split, const Aabb& cell, double least, const std::vector<Aabb>& boxes, std::span<const std::uint32_t> in_cell);

}  // namespace raymeter
