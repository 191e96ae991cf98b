#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "accel/zbuffer/bins.h"
#include "core/base/column.h"

namespace raymeter {

/// Rectangles of packets' samples on the image, column by column.
struct PacketRects {
  static constexpr int kMost = kCellSamples * kCellSamples;
  static constexpr int kRow = kMost + 16;  ///< rows are read a register past their end
  float min_x[kRow] = {}, max_x[kRow] = {}, min_y[kRow] = {}, max_y[kRow] = {};
};

/// Consecutive eye rays that lie in one cell, at most PacketRects::kMost of them, and the rectangles of their packets.
struct CellRun {
  std::size_t first = 0;
  std::int32_t count = 0;
  int cell_x = 0;
  int cell_y = 0;
  float x[PacketRects::kRow] = {};  ///< of the samples
  float y[PacketRects::kRow] = {};
  PacketRects rects;
};

/// Cuts eye rays into runs. In the order of PixelOrder most runs are whole cells, which are recognised at once; any other order is taken too.
class CellRuns {
public:
  /// Packets of so many rays. `pixels`, y * width + x, must outlive it.
  CellRuns(const ImagePlane& plane, const Column<std::int32_t>& pixels, int packet);
  /// The run that begins with ray `first` and ends before `end`.
  void next(std::size_t first, std::size_t end, CellRun& run) const noexcept;

private:
  [[nodiscard]] bool whole_cell(std::size_t first) const noexcept;

  const std::int32_t* pixels_;
  int width_, height_;
  int packet_;
  std::array<std::int32_t, PacketRects::kMost> order_;  ///< pixels of a whole cell, less the first
  CellRun cell_;                                        ///< a whole cell, its first sample at (0, 0)
};

}  // namespace raymeter
