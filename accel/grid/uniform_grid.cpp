#include "accel/grid/uniform_grid.h"

#include <algorithm>

namespace raymeter {

std::int64_t CellRange::count() const noexcept {
  std::int64_t product = 1;
  for (std::size_t a = 0; a < 3; ++a) product *= high[a] - low[a] + 1;
  return product;
}

std::int64_t UniformGrid::cell_count() const noexcept { return std::int64_t{frame.resolution[0]} * frame.resolution[1] * frame.resolution[2]; }

GridView UniformGrid::view(bool mailbox, bool from_origin, bool nearest_blocker) const noexcept {
  GridView view{pools.view(), frame, occupied.data(), first.data(), refs.data(),    static_cast<std::int32_t>(kinds.size()),
                {},           {},    mailbox,         from_origin,  nearest_blocker};
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    view.kind[k] = kinds[k];
    view.prim_count[k] = static_cast<std::int32_t>(pools.size(kinds[k]));
  }
  return view;
}

CellRange cells_of(const GridCells& cells, const std::array<double, 3>& margin, const Aabb& box) noexcept {
  CellRange range{};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int32_t last = cells.resolution[a] - 1;
    if (last == 0) continue;
    const float size = cells.cell_size[a], origin = cells.origin[a];
    const auto plane = [&](std::int32_t i) noexcept { return double{grid_plane(static_cast<float>(i), size, origin)}; };
    // An estimate, moved to where the planes themselves put it.
    const auto estimate = [&](double x) noexcept {
      return static_cast<std::int32_t>(std::clamp((x - double{origin}) * double{cells.inv_cell_size[a]}, 0.0, static_cast<double>(last)));
    };
    const double low = double{box.min[static_cast<glm::length_t>(a)]} - margin[a];
    const double high = double{box.max[static_cast<glm::length_t>(a)]} + margin[a];
    std::int32_t i = estimate(low);
    while (i < last && plane(i + 1) < low) ++i;
    while (i > 0 && plane(i) >= low) --i;
    range.low[a] = static_cast<std::uint16_t>(i);
    i = std::max(i, estimate(high));
    while (i > range.low[a] && plane(i) > high) --i;
    while (i < last && plane(i + 1) <= high) ++i;
    range.high[a] = static_cast<std::uint16_t>(i);
  }
  return range;
}

}  // namespace raymeter
