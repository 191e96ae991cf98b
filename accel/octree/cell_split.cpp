#include "accel/octree/cell_split.h"

#include <algorithm>
#include <limits>

namespace raymeter {

namespace {

double center(const Aabb& box, glm::length_t a) noexcept { return 0.5 * (double{box.min[a]} + double{box.max[a]}); }

/// Median of the objects, each where its box, or the box's part in the cell, has its centre.
double object_median(const SplitRule& rule, const Aabb& cell, glm::length_t a, const std::vector<Aabb>& boxes, std::span<const std::uint32_t> in_cell) {
  std::vector<double> centers;
  centers.reserve(in_cell.size());
  for (const std::uint32_t e : in_cell) {
    const double of_part = 0.5 * (double{std::max(boxes[e].min[a], cell.min[a])} + double{std::min(boxes[e].max[a], cell.max[a])});
    centers.push_back(rule.whole_boxes ? center(boxes[e], a) : of_part);
  }
  const auto half = centers.begin() + static_cast<std::ptrdiff_t>(centers.size() / 2);
  std::nth_element(centers.begin(), half, centers.end());
  double median = *half;
  if (rule.mean_median && centers.size() % 2 == 0) median = 0.5 * (median + *std::max_element(centers.begin(), half));
  return std::clamp(median, double{cell.min[a]}, double{cell.max[a]});
}

/// The cheapest plane of axis a.
double cost_plane(const SplitRule& rule, const Aabb& cell, glm::length_t a, const std::vector<Aabb>& boxes, std::span<const std::uint32_t> in_cell) {
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
      below[i] += (rule.count_centers ? at <= double{plane[i]} : boxes[e].min[a] <= plane[i]) ? 1 : 0;
      above[i] += (rule.count_centers ? at > double{plane[i]} : boxes[e].max[a] >= plane[i]) ? 1 : 0;
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
      whole_boxes(params.cost_median == "boxes"),
      mean_median(params.cost_middle == "mean"),
      length_cost(params.cost_measure == "length"),
      count_centers(params.cost_counts == "centers") {}

glm::vec3 split_point(const SplitRule& rule, const Aabb& cell, double least, const std::vector<Aabb>& boxes, std::span<const std::uint32_t> in_cell) {
  glm::vec3 point(std::numeric_limits<float>::infinity());
  for (glm::length_t a = 0; a < 3; ++a) {
    if (!(double{cell.max[a]} - double{cell.min[a]} >= least)) continue;
    const double plane = rule.split == OctreeSplit::cost ? cost_plane(rule, cell, a, boxes, in_cell) : center(cell, a);
    const auto rounded = static_cast<float>(plane);
    // A plane on the cell's border would divide nothing off.
    if (rounded > cell.min[a] && rounded < cell.max[a]) point[a] = rounded;
  }
  return point;
}

}  // namespace raymeter
