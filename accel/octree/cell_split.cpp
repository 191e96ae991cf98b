#include "accel/octree/cell_split.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace raymeter {

namespace {

ObjectMedian median_named(const std::string& name) noexcept {
  if (name == "mean") return ObjectMedian::mean_of_two;
  return name == "mean_of_all" ? ObjectMedian::mean_of_all : ObjectMedian::upper;
}

double center(const Aabb& box, glm::length_t a) noexcept { return 0.5 * (double{box.min[a]} + double{box.max[a]}); }

/// The objects' median, each where its box, or the box's part in the cell, has its centre.
double object_median(const SplitRule& rule, const Aabb& cell, glm::length_t a, const std::vector<Aabb>& boxes, std::span<const std::uint32_t> in_cell) {
  std::vector<double> centers;
  centers.reserve(in_cell.size());
  for (const std::uint32_t e : in_cell) {
    const double of_part = 0.5 * (double{std::max(boxes[e].min[a], cell.min[a])} + double{std::min(boxes[e].max[a], cell.max[a])});
    centers.push_back(rule.whole_boxes ? center(boxes[e], a) : of_part);
  }
  if (rule.median == ObjectMedian::mean_of_all) {
    const double mean = std::accumulate(centers.begin(), centers.end(), 0.0) / static_cast<double>(centers.size());
    return std::clamp(mean, double{cell.min[a]}, double{cell.max[a]});
  }
  const auto half = centers.begin() + static_cast<std::ptrdiff_t>(centers.size() / 2);
  std::nth_element(centers.begin(), half, centers.end());
  double median = *half;
  if (rule.median == ObjectMedian::mean_of_two && centers.size() % 2 == 0) median = 0.5 * (median + *std::max_element(centers.begin(), half));
  return std::clamp(median, double{cell.min[a]}, double{cell.max[a]});
}

/// The cheapest plane of axis a.
double cost_plane(const SplitRule& rule, const CellToSplit& of, glm::length_t a, const std::vector<Aabb>& boxes, std::span<const std::uint32_t> in_cell) {
  const Aabb& cell = of.box;
  const double from = center(cell, a), to = object_median(rule, cell, a, boxes, in_cell);
  const auto planes = static_cast<std::size_t>(rule.planes);
  std::array<float, kMostCostPlanes> plane{};
  std::array<std::int64_t, kMostCostPlanes> below{}, above{};
  for (std::size_t i = 0; i < planes; ++i) {
    const auto step = static_cast<double>(i);
    plane[i] = static_cast<float>(from + (to - from) * (rule.ends ? step / std::max(1, rule.planes - 1) : (step + 1) / (rule.planes + 1)));
  }
  for (const std::uint32_t e : in_cell) {
    const double at = center(boxes[e], a);
    for (std::size_t i = 0; i < planes; ++i) {
      const double at_plane{plane[i]};
      below[i] += (rule.count_centers ? at <= at_plane : double{boxes[e].min[a]} - of.margin <= at_plane) ? 1 : 0;
      above[i] += (rule.count_centers ? at > at_plane : double{boxes[e].max[a]} + of.margin >= at_plane) ? 1 : 0;
    }
  }
  const glm::dvec3 extent = glm::dvec3(cell.max) - glm::dvec3(cell.min);
  const double across = extent[(a + 1) % 3] * extent[(a + 2) % 3], around = extent[(a + 1) % 3] + extent[(a + 2) % 3];
  double least = std::numeric_limits<double>::infinity(), best = from;
  for (std::size_t i = 0; i < planes; ++i) {
    const auto area = [&](double length) noexcept { return rule.length_cost ? length : across + around * length; };
    const double cost = area(double{plane[i]} - double{cell.min[a]}) * static_cast<double>(below[i]) +
                        area(double{cell.max[a]} - double{plane[i]}) * static_cast<double>(above[i]);
    if (!(cost < least)) continue;
    least = cost;
    best = double{plane[i]};
  }
  return best;
}

}  // namespace

SplitRule::SplitRule(const OctreeParams& params)
    : split(params.split == "cost" ? OctreeSplit::cost : OctreeSplit::center),
      planes(params.cost_count),
      ends(params.cost_planes == "ends"),
      median(median_named(params.cost_middle)),
      whole_boxes(params.cost_median == "boxes"),
      length_cost(params.cost_measure == "length"),
      count_centers(params.cost_counts == "centers") {}

glm::vec3 split_point(const SplitRule& rule, const CellToSplit& cell, const std::vector<Aabb>& boxes, std::span<const std::uint32_t> in_cell) {
  glm::vec3 point(std::numeric_limits<float>::infinity());
  const Aabb& box = cell.box;
  for (glm::length_t a = 0; a < 3; ++a) {
    if (!(double{box.max[a]} - double{box.min[a]} >= cell.least)) continue;
    const double plane = rule.split == OctreeSplit::cost ? cost_plane(rule, cell, a, boxes, in_cell) : center(box, a);
    const auto rounded = static_cast<float>(plane);
    // A plane on the cell's border would divide nothing off.
    if (rounded > box.min[a] && rounded < box.max[a]) point[a] = rounded;
  }
  return point;
}

}  // namespace raymeter
