#pragma once

#include <cstdint>

#include "accel/grid/grid_layout.h"

namespace raymeter {

/// A grid inside a cell of another one, or the outermost: its cells follow each other from `first_cell` on.
struct NestedGrid : GridCells {
  std::int32_t first_cell;
};

/// What a cell is: empty, a list of primitives, or a grid.
struct CellLink {
  std::int32_t value = 0;
  [[nodiscard]] static constexpr CellLink to_list(std::int32_t list) noexcept { return {list + 1}; }
  [[nodiscard]] static constexpr CellLink to_grid(std::int32_t grid) noexcept { return {-grid - 1}; }
  [[nodiscard]] constexpr bool is_empty() const noexcept { return value == 0; }
  [[nodiscard]] constexpr bool is_grid() const noexcept { return value < 0; }
  [[nodiscard]] constexpr std::int32_t list() const noexcept { return value - 1; }
  [[nodiscard]] constexpr std::int32_t grid() const noexcept { return -value - 1; }
};

/// Levels of grids at most: the traversal calls itself once a level.
inline constexpr int kMaxGridLevels = 4;

/// Grids in cells of grids. List l holds, for each kind that the scene has, refs [first[l * kind_count + j], first[l * kind_count + j + 1]).
struct RecursiveGridView {
  PoolsView pools;
  GridFrame frame;  ///< of the outermost grid, which is grids[0]
  const NestedGrid* grids;
  const CellLink* cells;
  const std::int32_t* first;
  const std::int32_t* refs;
  std::int32_t kind_count;
  PrimKind kind[kPrimKindCount];
  std::int32_t prim_count[kPrimKindCount];  ///< in the whole scene, in the order of `kind`
  bool mailbox;
  bool from_origin;  ///< rays walk from their origin on, even where their interval begins later
};

}  // namespace raymeter
