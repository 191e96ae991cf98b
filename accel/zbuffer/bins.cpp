#include "accel/zbuffer/bins.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "core/trace/slices.h"

namespace raymeter {

namespace {

/// Entries that cells may have in all, before footprints of many cells become wide; and cells that any footprint may lie in.
constexpr std::int64_t kEntries = 1 << 22;
constexpr std::int64_t kLeastCells = 64;

/// What marks footprints of primitives that no sample sees.
constexpr float kUnseen = -1;

void make_footprints(const ImagePlane& plane, const Scene& scene, int threads, FootprintBins& bins) {
  bins.footprints.resize(static_cast<std::size_t>(scene.prim_id_count()));
  bins.planes.resize(bins.footprints.size());
  Footprint unseen{};
  unseen.nearest = kUnseen;
  for_each_slice(bins.footprints.size(), threads, [&](std::size_t, std::size_t begin, std::size_t count) {
    for (std::size_t i = begin; i < begin + count; ++i) {
      const PrimRef prim = scene.prim(static_cast<std::int32_t>(i));
      const auto seen = prim.dropped() ? std::nullopt : projected(plane, scene.pools(), prim);
      bins.footprints[i] = seen ? seen->print : unseen;
      bins.planes[i] = seen ? seen->plane : DepthPlane{};
    }
  });
}

struct Keyed {
  std::uint32_t depth;  ///< bits of a float >= 0 order as it does: here downwards
  std::int32_t prim;
};

/// The seen footprints by depth, equal ones by id: a radix sort.
std::vector<Keyed> nearest_first(const Column<Footprint>& footprints) {
  std::vector<Keyed> sorted;
  for (std::size_t i = 0; i < footprints.size(); ++i) {
    if (footprints[i].nearest != kUnseen) sorted.push_back({~std::bit_cast<std::uint32_t>(footprints[i].nearest), static_cast<std::int32_t>(i)});
  }
  std::vector<Keyed> other(sorted.size());
  constexpr int kDigit = 11;
  for (int shift = 0; shift < 32; shift += kDigit) {
    std::array<std::size_t, std::size_t{1} << kDigit> end{};
    const auto digit = [&](const Keyed& item) noexcept { return item.depth >> shift & ((1u << kDigit) - 1); };
    for (const Keyed& item : sorted) ++end[digit(item)];
    std::size_t sum = 0;
    for (std::size_t& e : end) sum += std::exchange(e, sum);
    for (const Keyed& item : sorted) other[end[digit(item)]++] = item;
    sorted.swap(other);
  }
  return sorted;
}

/// The cells of a footprint.
struct CellRange {
  int x0, x1, y0, y1;
  [[nodiscard]] std::int64_t count() const noexcept { return std::int64_t{x1 - x0 + 1} * (y1 - y0 + 1); }
};

/// First and last cell, of an axis with so many samples, of those between two coordinates.
std::array<int, 2> cells_between(float min, float max, int samples, int margin) noexcept {
  const double first = std::ceil((double{min} + (samples - 1)) / 2) - margin, last = std::floor((double{max} + (samples - 1)) / 2) + margin;
  const auto cell = [&](double sample) noexcept { return static_cast<int>(std::clamp(sample, 0.0, samples - 1.0)) / kCellSamples; };
  return {cell(first), cell(last)};
}

CellRange cells_of(const ImagePlane& plane, const Footprint& f, int margin) noexcept {
  const auto [x0, x1] = cells_between(f.min_x, f.max_x, plane.width, margin);
  const auto [y0, y1] = cells_between(f.min_y, f.max_y, plane.height, margin);
  return {x0, x1, y0, y1};
}

}  // namespace

void make_bins(const ImagePlane& plane, const Scene& scene, int margin, int threads, FootprintBins& bins) {
  make_footprints(plane, scene, threads, bins);
  const std::vector<Keyed> sorted = nearest_first(bins.footprints);
  bins.cells_across = (plane.width + kCellSamples - 1) / kCellSamples;
  const int cells_down = (plane.height + kCellSamples - 1) / kCellSamples;
  const std::int64_t most_cells = std::max(kLeastCells, kEntries / std::max<std::int64_t>(1, static_cast<std::int64_t>(sorted.size())));
  const auto for_each_cell = [&](const CellRange& range, auto visit) {
    for (int y = range.y0; y <= range.y1; ++y) {
      for (int x = range.x0; x <= range.x1; ++x) visit(static_cast<std::size_t>(y) * static_cast<std::size_t>(bins.cells_across) + static_cast<std::size_t>(x));
    }
  };
  const auto cell_count = static_cast<std::size_t>(bins.cells_across) * static_cast<std::size_t>(cells_down);
  bins.wide.clear();
  bins.first.clear();
  bins.first.resize(cell_count + 2, 0);  // counts of cell c at c + 2, then its place at c + 1, so that it ends as the next one's first
  std::vector<CellRange> ranges(sorted.size());
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    ranges[i] = cells_of(plane, bins.footprints[static_cast<std::size_t>(sorted[i].prim)], margin);
    if (ranges[i].count() > most_cells) {
      bins.wide.push_back(sorted[i].prim);
      ranges[i].x1 = -1;
    }
    for_each_cell(ranges[i], [&](std::size_t cell) { ++bins.first[cell + 2]; });
  }
  for (std::size_t cell = 2; cell < bins.first.size(); ++cell) bins.first[cell] += bins.first[cell - 1];
  bins.entries.clear();
  bins.entries.resize(static_cast<std::size_t>(bins.first.back()));
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    for_each_cell(ranges[i], [&](std::size_t cell) { bins.entries[static_cast<std::size_t>(bins.first[cell + 1]++)] = sorted[i].prim; });
  }
}

}  // namespace raymeter
