#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "accel/zbuffer/footprints.h"
#include "core/base/column.h"

namespace raymeter {

/// A frame's footprints, and which of them lie in each cell of 16 x 16 samples, nearest first. A footprint that covers very many cells is in no cell's list but
/// in one that all share, so that memory is a few words a primitive and a word a cell.
struct FootprintBins {
  Column<Footprint> footprints;  ///< of all primitives, by id
  Column<DepthPlane> planes;     ///< likewise
  Column<std::int32_t> wide;     ///< those that all cells share
  Column<std::int32_t> first;    ///< of each cell, row by row, in `entries`; the last is the end
  Column<std::int32_t> entries;
  int cells_across = 0;

  [[nodiscard]] std::span<const std::int32_t> cell(int x, int y) const noexcept {
    const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(cells_across) + static_cast<std::size_t>(x);
    return entries.span().subspan(static_cast<std::size_t>(first[i]), static_cast<std::size_t>(first[i + 1] - first[i]));
  }
};

inline constexpr int kCellSamples = 16;

/// Projects the scene's primitives and sorts them into cells, which reach `margin` samples further than their own. The same on any number of threads (0: all).
/// Columns of `bins` are used again.
void make_bins(const ImagePlane& plane, const Scene& scene, int margin, int threads, FootprintBins& bins);

}  // namespace raymeter
