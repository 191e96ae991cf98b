#include "accel/octree/cell_split.h"

#include <algorithm>
#include <limits>

namespace raymeter {

namespace {

constexpr int kPlanes = 10;

double middle(const Aabb& cell, glm::length_t a) noexcept { return 0.5 * (double{cell.min[a]} + double{cell.max[a]}); }

/// Median of the centres of the boxes' parts in the cell.
double object_median(const Aabb& cell, glm::length_t a, const std::vector<Aabb>& boxes, std::span<const std::uint32_t> in_cell) {
  std::vector<double> centers;
  centers.reserve(in_cell.size());
  for (const std::uint32_t e : in_cell) {
    centers.push_back(0.5 * (double{std::max(boxes[e].min[a], cell.min[a])} + double{std::min(boxes[e].max[a], cell.max[a])}));
  }
  const auto half = centers.begin() + static_cast<std::ptrdiff_t>(centers.size() / 2);
  std::nth_element(centers.begin(), half, centers.end());
  return std::clamp(*half, double{cell.min[a]}, double{cell.max[a]});
}

/// The cheapest plane of axis a.
double cost_plane(const Aabb& cell, glm::length_t a, const std::vector<Aabb>& boxes, std::span<const std::uint32_t> in_cell) {
  const double from = middle(cell, a), to = object_median(cell, a, boxes, in_cell);
  std::array<float, kPlanes> plane{};
  std::array<std::int64_t, kPlanes> below{}, above{};
  for (std::size_t i = 0; i < kPlanes; ++i) plane[i] = static_cast<float>(from + (to - from) * static_cast<double>(i + 1) / (kPlanes + 1));
  for (const std::uint32_t e : in_cell) {
    for (std::size_t i = 0; i < kPlanes; ++i) {
      below[i] += boxes[e].min[a] <= plane[i] ? 1 : 0;
      above[i] += boxes[e].max[a] >= plane[i] ? 1 : 0;
    }
  }
  const glm::dvec3 extent = glm::dvec3(cell.max) - glm::dvec3(cell.min);
  const double across = extent[(a + 1) % 3] * extent[(a + 2) % 3], around = extent[(a + 1) % 3] + extent[(a + 2) % 3];
  double least = std::numeric_limits<double>::infinity(), best = from;
  for (std::size_t i = 0; i < kPlanes; ++i) {
    const auto area = [&](double length) noexcept { return across + around * length; };
    const double cost = area(double{plane[i]} - double{cell.min[a]}) * static_cast<double>(below[i]) +
                        area(double{cell.max[a]} - double{plane[i]}) * static_cast<double>(above[i]);
    if (!(cost < least)) continue;
    least = cost;
    best = double{plane[i]};
  }
  return best;
}

}  // namespace

glm::vec3 split_point(OctreeSplit split, const Aabb& cell, double least, const std::vector<Aabb>& boxes, std::span<const std::uint32_t> in_cell) {
  glm::vec3 point(std::numeric_limits<float>::infinity());
  for (glm::length_t a = 0; a < 3; ++a) {
    if (!(double{cell.max[a]} - double{cell.min[a]} >= least)) continue;
    const double plane = split == OctreeSplit::cost ? cost_plane(cell, a, boxes, in_cell) : middle(cell, a);
    const auto rounded = static_cast<float>(plane);
    // A plane on the cell's border would divide nothing off.
    if (rounded > cell.min[a] && rounded < cell.max[a]) point[a] = rounded;
  }
  return point;
}

}  // namespace raymeter
