#pragma once

#include "accel/grid/grid.h"
#include "accel/grid/uniform_grid.h"

namespace raymeter {

/// Whether cells have planes inside too: then axes of a single cell get a frame as well, for grids in cells.
enum class GridPlanes : std::uint8_t { between_cells, inside_too };

/// The box by which a primitive is put into cells: padded, and larger still by what the parameters ask for its kind.
[[nodiscard]] Aabb listed_box(const Pools& pools, PrimRef ref, const GridParams& params) noexcept;

/// Lists every primitive in all cells that its padded box touches: a counting sort by cell and kind, in two passes over the primitives. The same on any number
/// of threads (0: all). An automatic resolution is halved until the grid has at most 32 references per primitive (and a million): many large primitives would
/// else fill the memory. Throws Error where the grid cannot be numbered with 32 bits.
[[nodiscard]] UniformGrid build_uniform_grid(const Scene& scene, const GridParams& params, int threads, GridPlanes planes = GridPlanes::between_cells);

}  // namespace raymeter
