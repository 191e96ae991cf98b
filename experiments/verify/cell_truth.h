#pragma once

#include <cstdint>
#include <vector>

#include "core/ray/ray_batch.h"
#include "core/trace/cell_walk.h"
#include "experiments/verify/verify.h"

namespace raymeter {

/// How the cells that rays visit compare with those that they pass through.
struct CellAccuracy {
  std::int64_t rays_checked = 0;  ///< that walk
  std::int64_t rays_missing = 0;  ///< of them those that do not visit every cell in which they go some way
  std::int64_t rays_at_risk = 0;  ///< that go further in such a cell than lists reach beyond cells: a hit there may be lost
  std::int64_t cells_missed = 0;
  double longest = 0;  ///< way of a ray in a cell that it misses: of all axes the largest, in cells
};

/// A cell and the way of a ray in it along each axis, in units of space.
struct PassedCell {
  std::int32_t cell;
  std::array<double, 3> way;
};

/// The cells in whose interior a ray goes some way between its ends and inside the box, in its order: decided in doubles with an error bound, and in rationals
/// where that is not enough. It shares no code with the walk. A ray that lies in a plane between cells passes through no interior; nor does an invalid one.
[[nodiscard]] std::vector<PassedCell> cells_passed(const CellWalk::Cells& cells, const Ray& ray);

/// Holds the walk against the truth, for so many rays that rays x cells on the longest way keep to the budget.
[[nodiscard]] CellAccuracy verify_cells(const CellWalk& walk, const RayBatch& rays, const OracleBudget& budget);

}  // namespace raymeter
