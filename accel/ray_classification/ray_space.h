#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "accel/ray_classification/ray_cells_layout.h"
#include "accel/ray_classification/ray_classification.h"
#include "core/base/column.h"
#include "core/bounds/aabb.h"

namespace raymeter {

/// How the five-dimensional space of a scene's rays is divided: which axis each split halves. All cells of a class at one depth have the same shape.
class RaySpace {
public:
  /// `box` is around the padded boxes of all primitives; empty where there are none.
  RaySpace(const Aabb& box, const RayClassificationParams& params);

  [[nodiscard]] RayClassFrame frame() const noexcept;
  /// Splits from a class to its smallest cells.
  [[nodiscard]] int depth(std::int32_t ray_class) const noexcept { return static_cast<int>(split_axis_[static_cast<std::size_t>(ray_class)].size()); }
  /// The axis that the cells at `depth` are split on.
  [[nodiscard]] int split_axis(std::int32_t ray_class, int depth) const noexcept {
    return split_axis_[static_cast<std::size_t>(ray_class)][static_cast<std::size_t>(depth)];
  }
  [[nodiscard]] int key_bits() const noexcept { return frame_.key_bits; }
  /// By how much beams are to be grown (beam.h).
  [[nodiscard]] double padding() const noexcept { return padding_; }
  /// World axis of ray axis 0, 1 or 2.
  [[nodiscard]] static int world_axis(std::int32_t ray_class, int axis) noexcept { return (ray_class / 2 + 1 + axis) % 3; }
  /// Where on a world axis, or among slopes (axis 3), the part `index` of 2^splits equal parts begins; index 2^splits is where the last one ends.
  [[nodiscard]] double border(int axis, int splits, std::uint32_t index) const noexcept;
  [[nodiscard]] std::size_t mem_bytes() const noexcept { return spread_.bytes(); }

private:
  void choose_splits(std::int32_t ray_class, const std::array<double, 3>& extent, const RayClassificationParams& params);
  void fill_spread();

  RayClassFrame frame_{};
  std::array<int, 4> bits_{};       ///< splits of the world axes, and of slopes
  std::array<double, 4> low_{};     ///< where they begin
  std::array<double, 4> length_{};  ///< of all cells together
  std::array<std::vector<std::uint8_t>, kRayClasses> split_axis_;
  Column<std::uint64_t> spread_;
  double padding_ = 0;
};

}  // namespace raymeter
