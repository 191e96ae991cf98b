#include "accel/grid/grid_resolution.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "core/geometry/error_bounds.h"

namespace raymeter {

namespace {

std::int32_t cells(double wanted, std::int32_t max_resolution) {
  return static_cast<std::int32_t>(std::clamp(wanted, 1.0, static_cast<double>(max_resolution)));  // truncates
}

GridResolution explicit_resolution(const std::string& text) {
  constexpr std::int32_t kMost = 65535;
  GridResolution resolution{};
  const char* at = text.data();
  const char* const end = at + text.size();
  for (std::size_t a = 0; a < 3; ++a) {
    const auto [next, error] = std::from_chars(at, end, resolution[a]);
    const bool separated = a == 2 ? next == end : next != end && *next == 'x';
    if (error != std::errc{} || !separated || resolution[a] < 1 || resolution[a] > kMost) {
      throw Error("resolution: expected auto or NXxNYxNZ, each from 1 to 65535, got '" + text + "'");
    }
    at = next + 1;
  }
  return resolution;
}

/// The edge of a cube such that `cells` of them fill the box; axes shorter than the edge do not count, since they get one cell whatever the edge.
double cube_edge(const glm::dvec3& extent, double cells) {
  std::array<double, 3> size{extent.x, extent.y, extent.z};
  std::sort(size.begin(), size.end(), std::greater<>());
  double edge = size[0] / cells;
  if (size[1] > edge) edge = std::sqrt(size[0] / cells * size[1]);
  if (size[2] > edge) edge = std::cbrt(size[0] / cells * size[1] * size[2]);
  return edge;
}

}  // namespace

GridResolution grid_resolution(const GridParams& params, const glm::dvec3& extent, std::int64_t prim_count) {
  if (params.resolution != "auto") return explicit_resolution(params.resolution);
  const double count = static_cast<double>(prim_count);
  const double largest = std::max({extent.x, extent.y, extent.z});
  GridResolution resolution{1, 1, 1};
  if (!(largest > 0) || prim_count == 0) return resolution;
  const double edge = cube_edge(extent, std::max(1.0, params.density * count));
  for (std::size_t a = 0; a < 3; ++a) {
    const double size = extent[static_cast<glm::length_t>(a)];
    const double wanted = params.rule == "woo"         ? size / largest * std::cbrt(params.density * count)
                          : params.rule == "customary" ? params.density * std::cbrt(count)
                                                       : size / edge + 0.5;
    // A cube of 8 has the root 2, which is not to become 1 by rounding.
    resolution[a] = cells(wanted * (1 + 0x1p-40), params.max_resolution);
  }
  return resolution;
}

double finest_cell(const Aabb& box, glm::length_t a) noexcept {
  const double farthest = std::max(std::abs(double{box.min[a]}), std::abs(double{box.max[a]}));
  return std::max(4 * double{kBoundsPadding} * farthest, 0x1p-100);
}

std::int32_t useful_resolution(const Aabb& box, glm::length_t a) noexcept {
  const double extent = double{box.max[a]} - double{box.min[a]};
  const double least = finest_cell(box, a);
  // An extent beyond float's range would make planes of infinity.
  if (!(extent >= least) || extent > double{std::numeric_limits<float>::max()}) return 1;
  return static_cast<std::int32_t>(std::min(extent / least, 65535.0));
}

}  // namespace raymeter
