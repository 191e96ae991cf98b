#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "accel/grid/grid_layout.h"
#include "core/base/column.h"
#include "core/bounds/aabb.h"
#include "core/scene/pools.h"

namespace raymeter {

/// A built uniform grid: see GridView for what the columns hold.
struct UniformGrid {
  GridFrame frame{};
  std::array<double, 3> margin{};       ///< how far beyond a cell its list reaches on each axis, so that it holds every hit that a ray may have there
  std::array<double, 3> finest_cell{};  ///< cells of a grid inside a cell are not to be smaller; 0 where an axis has no planes at all
  std::vector<PrimKind> kinds;          ///< that the scene has
  Pools pools;                          ///< the scene's primitives in the order of the first cell that lists them
  Column<std::uint32_t> occupied;
  Column<std::int32_t> first;
  Column<std::uint32_t> refs;  ///< in the scene's order within a cell and kind

  [[nodiscard]] std::int64_t cell_count() const noexcept;
  [[nodiscard]] GridView view(bool mailbox, bool from_origin, bool nearest_blocker) const noexcept;
};

/// The cells that a box touches, per axis from `low` to `high`, both included.
struct CellRange {
  std::array<std::uint16_t, 3> low;
  std::array<std::uint16_t, 3> high;
  [[nodiscard]] std::int64_t count() const noexcept;
};

/// The cells whose closed box, grown by the margin, meets `box`.
[[nodiscard]] CellRange cells_of(const GridCells& cells, const std::array<double, 3>& margin, const Aabb& box) noexcept;

}  // namespace raymeter
