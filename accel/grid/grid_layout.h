#pragma once

#include <cstdint>

#include "core/scene/pools_view.h"
#include "core/scene/primitive.h"

namespace raymeter {

/// How a DDA comes by the crossing of the next plane (dda_form_kernel.h).
enum class DdaForm : std::uint8_t { recompute, divide, fma, accumulate, compensated };

/// Stands for the number of cells that a ray visits which is tested against everything (CellWalk in core/trace/cell_walk.h).
inline constexpr std::int32_t kWalksEverywhere = -1;

/// Where the cells of a grid lie. Cell (i, j, k) is number i + (j + k * resolution[1]) * resolution[0]; the cells at the border reach to infinity.
struct GridCells {
  float origin[3];
  float cell_size[3];
  float inv_cell_size[3];
  std::int32_t resolution[3];
};

/// The cells over a scene, and for which rays their lists are complete (grid_walk_kernel.h has the proof).
struct GridFrame : GridCells {
  float box[6];  ///< around all that can be hit: min x y z, max x y z
  float center[3];
  float reach[3];      ///< a ray's origin may lie this far from `center`; infinite where there is one cell
  float max_speed[3];  ///< largest |dir|
};

/// Plane `index` of an axis, 1 .. resolution - 1: below it lies cell index - 1. Not fused, so that builder and kernels of every instruction set see the same.
template <class Float>
[[nodiscard]] inline Float grid_plane(Float index, Float cell_size, Float origin) noexcept {
  return index * cell_size + origin;
}

/// An entry of a cell's list: the primitive's index in the pool of its kind, and on which sides of the cell the neighbour lists it too.
struct GridRef {
  static constexpr int kIndexBits = 26;
  static constexpr std::uint32_t kIndexMask = (1u << kIndexBits) - 1;
  /// Bit of the neighbour that is reached by going down (side 0) or up (side 1) an axis.
  [[nodiscard]] static constexpr std::uint32_t neighbour_bit(int axis, int side) noexcept { return 1u << (2 * axis + side); }
};

/// A uniform grid. Cell c lists, for each kind that the scene has, refs [first[c * kind_count + j], first[c * kind_count + j + 1]).
struct GridView {
  PoolsView pools;
  GridFrame frame;
  const std::uint32_t* occupied;  ///< one bit per cell: whether its list holds anything; what most steps need to know, and 32 times smaller than `first`
  const std::int32_t* first;
  const std::uint32_t* refs;
  std::int32_t kind_count;
  PrimKind kind[kPrimKindCount];
  std::int32_t prim_count[kPrimKindCount];  ///< in the whole scene, in the order of `kind`
  bool mailbox;
  bool from_origin;      ///< rays walk from their origin on, even where their interval begins later
  bool nearest_blocker;  ///< rays that ask for any hit end at the nearest
};

}  // namespace raymeter
