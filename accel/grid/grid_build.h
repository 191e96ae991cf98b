#pragma once

#include "accel/grid/grid.h"
#include "accel/grid/uniform_grid.h"

namespace raymeter {

/// Lists every primitive in all cells that its padded box touches: a counting sort by cell and kind, in two passes over the primitives. The same on any number
/// of threads (0: all). An automatic resolution is halved until the grid has at most 32 references per primitive (and a million): many large primitives would
/// else fill the memory. Throws Error where the grid cannot be numbered with 32 bits.
[[nodiscard]] UniformGrid build_uniform_grid(const Scene& scene, const GridParams& params, int threads);

}  // namespace raymeter
