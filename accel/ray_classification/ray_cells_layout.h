#pragma once

#include <cstdint>

#include "core/ray/views.h"
#include "core/scene/pools_view.h"
#include "core/scene/primitive.h"

namespace raymeter {

/// The coordinates of a ray, after its class: where it starts, across (0, 1) and along (2) its dominant axis, and its slopes (3, 4): what it moves across per
/// unit of way along, in [-1, 1]. Axis c of 0, 1, 2 is world axis (dominant + 1 + c) % 3; slope 3 + c belongs to axis c.
inline constexpr int kRayAxes = 5;
/// A class is a dominant axis and a direction along it: 2 * axis + (1 where that component is negative).
inline constexpr std::int32_t kRayClasses = 6;
/// Rays that no cell serves and that are tested against everything; and those that meet nothing: they come after all classes.
inline constexpr std::int32_t kUnclassified = 6;
inline constexpr std::int32_t kNowhere = 7;
/// A coordinate has at most twice so many bits.
inline constexpr int kHalfBits = 6;

/// How rays become keys. Key: class, then one bit for each split, the first one highest: a cell's rays are those whose keys begin like it.
struct RayClassFrame {
  bool beams;    ///< long lists are culled by the packets' own beams
  float box[6];  ///< around all that can be hit: min x y z, max x y z
  float center[3];
  float reach[3];    ///< a ray's origin may lie so far from `center`
  float most_slack;  ///< RayPacket::slab_slack of rays that begin behind their origins, at most: what those within reach can need
  float cells_per_unit[3];
  float last_cell[3];
  float slope_cells;  ///< cells per unit of slope; all slope axes have as many
  float last_slope;
  std::int32_t key_bits;        ///< without the class
  const std::uint64_t* spread;  ///< key bits of each half of a coordinate: [class][axis][half][1 << kHalfBits], the lower half first
};

/// A primitive of a cell's list. Lists ascend by `start`: where the primitive begins along the class' direction, the coordinate negated for negative ones.
struct Candidate {
  static constexpr int kKindShift = 29;
  float start;
  std::uint32_t ref;

  [[nodiscard]] std::int32_t index() const noexcept { return static_cast<std::int32_t>(ref & ((1u << kKindShift) - 1)); }
  [[nodiscard]] std::uint32_t kind() const noexcept { return ref >> kKindShift; }
};

/// A cell as it is traced.
struct RayCell {
  const Candidate* list;
  std::int32_t count;
  std::int32_t ray_class;
};

/// A slice of a batch whose rays are sorted by their cells.
struct RayCellsView {
  PoolsView pools;
  std::int32_t prim_count[kPrimKindCount];
  bool beams;    ///< long lists are culled by the packets' own beams
  float box[6];  ///< around all that can be hit: min x y z, max x y z
  const RayCell* cells;
  const std::int32_t* cell;   ///< of each ray of the slice, in order
  const std::int32_t* order;  ///< its place in the batch
};

}  // namespace raymeter
