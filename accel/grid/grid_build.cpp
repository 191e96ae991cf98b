#include "accel/grid/grid_build.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/parallel_scan.h>

#include "accel/grid/grid_resolution.h"
#include "accel/thin_box.h"
#include "core/base/threads.h"
#include "core/geometry/error_bounds.h"

namespace raymeter {

namespace {

using Range = tbb::blocked_range<std::size_t>;
constexpr std::size_t kGrain = 4096;
constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();

/// How far a hit may lie off its primitive's box and the ray's cell together, relative to its distance from the origin: 3 roundings of the crossing, and 1 to
/// spare. grid_walk_kernel.h has the proof.
constexpr double kGridError = double{kPrimitiveError} + 4 * double{kUnitRoundoff};
/// Rays that start up to this many extents away always use the grid.
constexpr double kLeastReach = 8;

struct Bounds {
  Aabb tight;
  Aabb padded;
};

double largest_coordinate(const Aabb& box, glm::length_t a) noexcept { return std::max(std::abs(double{box.min[a]}), std::abs(double{box.max[a]})); }

/// The box that reaches further on its low and on its high sides, by shares of its extent.
Aabb grown(Aabb box, double low, double high) noexcept {
  constexpr double kFarthest = std::numeric_limits<float>::max();
  if (box.empty() || (low == 0 && high == 0)) return box;
  for (glm::length_t a = 0; a < 3; ++a) {
    const double from = box.min[a], to = box.max[a];
    box.min[a] = static_cast<float>(std::max(from - low * (to - from), -kFarthest));
    box.max[a] = static_cast<float>(std::min(to + high * (to - from), kFarthest));
  }
  return box;
}

class GridBuilder {
public:
  GridBuilder(const Scene& scene, GridPlanes planes) : pools_(scene.pools()), planes_(planes) {
    for (std::size_t k = 0; k < kPrimKindCount; ++k) {
      const auto kind = static_cast<PrimKind>(k);
      const std::size_t count = pools_.size(kind);
      if (count > GridRef::kIndexMask + std::size_t{1}) throw Error("grid: at most 67108864 primitives of one kind");
      if (count == 0) continue;
      first_entry_.push_back(entry_count_);
      grid_.kinds.push_back(kind);
      entry_count_ += count;
    }
    if (grid_.kinds.empty()) grid_.kinds.push_back(PrimKind::triangle);  // a list of none
    entries_.resize(entry_count_);
  }

  UniformGrid run(const GridParams& params) {
    params_ = params;
    const Bounds found = find_bounds();
    const Bounds bounds{grown(found.tight, params.growth_low, params.growth_high), grown(found.padded, params.growth_low, params.growth_high)};
    const glm::dvec3 extent = bounds.tight.empty() ? glm::dvec3(0.0) : glm::dvec3(bounds.tight.max) - glm::dvec3(bounds.tight.min);
    GridResolution resolution = grid_resolution(params, extent, static_cast<std::int64_t>(entry_count_));
    for (std::size_t a = 0; a < 3; ++a) resolution[a] = std::min(resolution[a], useful_resolution(bounds.tight, static_cast<glm::length_t>(a)));
    const std::int64_t allowed = params.resolution == "auto" ? 32 * static_cast<std::int64_t>(entry_count_) + (1 << 20) : kMost;
    for (;;) {
      place(bounds, resolution);
      const std::int64_t slots = grid_.cell_count() * static_cast<std::int64_t>(grid_.kinds.size());
      const std::int64_t references = slots < kMost ? count_references() : kMost;
      if (slots < kMost && references <= allowed && references < kMost) break;
      if (params.resolution != "auto" || slots >= kMost) {
        throw Error((params.resolution != "auto" ? "resolution" : "density") + std::string(": a grid of ") + std::to_string(grid_.cell_count()) +
                    " cells and " + (slots < kMost ? std::to_string(references) + " references" : "their lists") + " is too large; expected less than 2^31");
      }
      for (std::int32_t& n : resolution) n = (n + 1) / 2;
    }
    count_cells();
    scatter();
    mark_occupied();
    bring_together();
    return std::move(grid_);
  }

private:
  [[nodiscard]] PrimRef prim(std::size_t entry) const noexcept {
    std::size_t k = grid_.kinds.size() - 1;
    while (entry < first_entry_[k]) --k;
    return prim_ref(grid_.kinds[k], entry - first_entry_[k]);
  }

  [[nodiscard]] Bounds find_bounds() const {
    return tbb::parallel_reduce(
        Range(0, entry_count_, kGrain), Bounds{},
        [&](const Range& range, Bounds sum) {
          for (std::size_t e = range.begin(); e < range.end(); ++e) {
            const Aabb box = thickened(tight_bounds(pools_, prim(e)), prim(e).kind(), static_cast<float>(params_.thin_padding));
            sum.tight.grow(box);
            sum.padded.grow(padded(box));
          }
          return sum;
        },
        [](Bounds a, const Bounds& b) {
          a.tight.grow(b.tight);
          a.padded.grow(b.padded);
          return a;
        });
  }

  /// Lays out the cells, and how far from them a ray may start (grid_walk_kernel.h).
  void place(const Bounds& bounds, const GridResolution& resolution) {
    GridFrame& frame = grid_.frame;
    for (std::size_t a = 0; a < 3; ++a) {
      const auto axis = static_cast<glm::length_t>(a);
      const double low = double{bounds.padded.min[axis]}, high = double{bounds.padded.max[axis]};
      frame.box[a] = bounds.padded.min[axis];
      frame.box[a + 3] = bounds.padded.max[axis];
      frame.resolution[a] = resolution[a];
      frame.reach[a] = std::numeric_limits<float>::infinity();
      frame.max_speed[a] = 0x1p126f;
      grid_.finest_cell[a] = 0;
      const bool planes_inside = planes_ == GridPlanes::inside_too && useful_resolution(bounds.tight, axis) > 1;
      if (resolution[a] == 1 && !planes_inside) continue;  // no planes: size and origin are of no use
      const double extent = double{bounds.tight.max[axis]} - double{bounds.tight.min[axis]};
      const double cell = extent / resolution[a];
      grid_.margin[a] = std::max(params_.margin * cell, kGridError * kLeastReach * extent);
      grid_.finest_cell[a] = std::max(finest_cell(bounds.tight, axis), 2 * grid_.margin[a]);
      // Boxes that touch a plane of the exact division would be listed on both of its sides, and regular scenes are full of them. With the planes a little
      // higher only those that begin there are, with the planes a little lower only those that end there: what programs do whose coordinates are rounded to
      // cells in one direction.
      const double shift = 2 * (grid_.margin[a] + double{kBoundsPadding} * largest_coordinate(bounds.tight, axis));
      const double raised = params_.touching == "all" ? 0 : params_.touching == "end" ? -shift : shift;
      frame.origin[a] = static_cast<float>(double{bounds.tight.min[axis]} + raised);
      frame.cell_size[a] = static_cast<float>(cell);
      frame.inv_cell_size[a] = static_cast<float>(1 / cell);
      frame.center[a] = static_cast<float>(0.5 * (low + high));
      frame.reach[a] = static_cast<float>(grid_.margin[a] / kGridError - 0.5 * (high - low));
      frame.max_speed[a] = static_cast<float>(std::min(0x1p126, cell * 0x1p120));
    }
  }

  /// Finds every entry's cells; returns how many references that makes.
  std::int64_t count_references() {
    return tbb::parallel_reduce(
        Range(0, entry_count_, kGrain), std::int64_t{0},
        [&](const Range& range, std::int64_t sum) {
          for (std::size_t e = range.begin(); e < range.end(); ++e) {
            entries_[e] = cells_of(grid_.frame, grid_.margin, listed_box(pools_, prim(e), params_));
            // Saturating: the sum of 2^26 products of three 16-bit numbers may exceed 63 bits.
            sum = std::min(sum + std::min(entries_[e].count(), kMost), kMost);
          }
          return sum;
        },
        [](std::int64_t a, std::int64_t b) { return std::min(a + b, kMost); });
  }

  /// Calls body(slot in `first`, reference) for each cell that entry e touches.
  template <class Body>
  void for_each_cell(std::size_t e, Body&& body) const {
    const PrimRef ref = prim(e);
    const auto kind_count = static_cast<std::int64_t>(grid_.kinds.size());
    const std::int64_t kind = std::find(grid_.kinds.begin(), grid_.kinds.end(), ref.kind()) - grid_.kinds.begin();
    const CellRange& cells = entries_[e];
    const auto neighbours = [&](std::size_t a, std::uint32_t i) noexcept {
      const int axis = static_cast<int>(a);
      return (i > cells.low[a] ? GridRef::neighbour_bit(axis, 0) : 0u) | (i < cells.high[a] ? GridRef::neighbour_bit(axis, 1) : 0u);
    };
    for (std::uint32_t z = cells.low[2]; z <= cells.high[2]; ++z) {
      for (std::uint32_t y = cells.low[1]; y <= cells.high[1]; ++y) {
        const std::int64_t row = (std::int64_t{z} * grid_.frame.resolution[1] + y) * grid_.frame.resolution[0];
        const std::uint32_t beside = neighbours(1, y) | neighbours(2, z);
        for (std::uint32_t x = cells.low[0]; x <= cells.high[0]; ++x) {
          body(static_cast<std::size_t>((row + x) * kind_count + kind), ref.index | (beside | neighbours(0, x)) << GridRef::kIndexBits);
        }
      }
    }
  }

  /// First pass: first[slot] becomes the end of the slot's list, which the second pass moves to its beginning.
  void count_cells() {
    const auto slots = static_cast<std::size_t>(grid_.cell_count()) * grid_.kinds.size();
    grid_.first.resize(slots + 1);
    tbb::parallel_for(Range(0, entry_count_, kGrain), [&](const Range& range) {
      for (std::size_t e = range.begin(); e < range.end(); ++e) {
        for_each_cell(e, [&](std::size_t slot, std::uint32_t) { std::atomic_ref(grid_.first[slot]).fetch_add(1, std::memory_order_relaxed); });
      }
    });
    const std::int32_t references = tbb::parallel_scan(
        Range(0, slots, 16 * kGrain), std::int32_t{0},
        [&](const Range& range, std::int32_t sum, bool final) {
          for (std::size_t slot = range.begin(); slot < range.end(); ++slot) {
            sum += grid_.first[slot];
            if (final) grid_.first[slot] = sum;
          }
          return sum;
        },
        [](std::int32_t a, std::int32_t b) { return a + b; });
    grid_.first[slots] = references;
    grid_.refs.resize(static_cast<std::size_t>(references));
  }

  /// Second pass, and the order that the threads' race leaves open.
  void scatter() {
    tbb::parallel_for(Range(0, entry_count_, kGrain), [&](const Range& range) {
      for (std::size_t e = range.begin(); e < range.end(); ++e) {
        for_each_cell(e, [&](std::size_t slot, std::uint32_t ref) {
          const std::int32_t end = std::atomic_ref(grid_.first[slot]).fetch_sub(1, std::memory_order_relaxed);
          grid_.refs[static_cast<std::size_t>(end - 1)] = ref;
        });
      }
    });
    const std::size_t slots = grid_.first.size() - 1;
    tbb::parallel_for(Range(0, slots, 16 * kGrain), [&](const Range& range) {
      for (std::size_t slot = range.begin(); slot < range.end(); ++slot) {
        std::sort(grid_.refs.data() + grid_.first[slot], grid_.refs.data() + grid_.first[slot + 1],
                  [](std::uint32_t a, std::uint32_t b) { return (a & GridRef::kIndexMask) < (b & GridRef::kIndexMask); });
      }
    });
  }

  void mark_occupied() {
    const auto cells = static_cast<std::size_t>(grid_.cell_count());
    const std::size_t kinds = grid_.kinds.size();
    grid_.occupied.resize((cells + 31) / 32);
    tbb::parallel_for(Range(0, grid_.occupied.size(), kGrain), [&](const Range& range) {
      for (std::size_t cell = 32 * range.begin(); cell < std::min(cells, 32 * range.end()); ++cell) {
        const bool any = grid_.first[cell * kinds] != grid_.first[(cell + 1) * kinds];
        grid_.occupied[cell / 32] |= (any ? 1u : 0u) << cell % 32;
      }
    });
  }

  /// Copies the primitives in the order of the first cell that lists them, so that those of a cell are read from few places.
  void bring_together() {
    std::vector<PrimRef> order;
    order.reserve(entry_count_);
    std::vector<std::uint32_t> moved(entry_count_);  // per entry: its new index
    constexpr std::uint32_t kBelow = GridRef::neighbour_bit(0, 0) | GridRef::neighbour_bit(1, 0) | GridRef::neighbour_bit(2, 0);
    const std::size_t kinds = grid_.kinds.size();
    std::vector<std::uint32_t> next(kinds);
    for (std::size_t slot = 0; slot + 1 < grid_.first.size(); ++slot) {
      const std::size_t k = slot % kinds;
      for (std::int32_t r = grid_.first[slot]; r < grid_.first[slot + 1]; ++r) {
        const std::uint32_t ref = grid_.refs[static_cast<std::size_t>(r)];
        if ((ref >> GridRef::kIndexBits & kBelow) != 0) continue;
        const std::uint32_t index = ref & GridRef::kIndexMask;
        order.push_back(prim_ref(grid_.kinds[k], index));
        moved[first_entry_[k] + index] = next[k]++;
      }
    }
    tbb::parallel_for(Range(0, grid_.first.size() - 1, 16 * kGrain), [&](const Range& range) {
      for (std::size_t slot = range.begin(); slot < range.end(); ++slot) {
        for (std::int32_t r = grid_.first[slot]; r < grid_.first[slot + 1]; ++r) {
          std::uint32_t& ref = grid_.refs[static_cast<std::size_t>(r)];
          ref = (ref & ~GridRef::kIndexMask) | moved[first_entry_[slot % kinds] + (ref & GridRef::kIndexMask)];
        }
      }
    });
    grid_.pools = reordered(pools_, order);
  }

  const Pools& pools_;
  GridPlanes planes_;
  GridParams params_;
  UniformGrid grid_;
  std::vector<std::size_t> first_entry_;  ///< per kind
  std::vector<CellRange> entries_;
  std::size_t entry_count_ = 0;
};

}  // namespace

Aabb listed_box(const Pools& pools, PrimRef ref, const GridParams& params) noexcept {
  Aabb box = thickened(padded_bounds(pools, ref), ref.kind(), static_cast<float>(params.thin_padding));
  if (ref.kind() == PrimKind::cone) {
    box.min -= glm::vec3(static_cast<float>(params.cone_padding));
    box.max += glm::vec3(static_cast<float>(params.cone_padding));
  }
  return box;
}

UniformGrid build_uniform_grid(const Scene& scene, const GridParams& params, int threads, GridPlanes planes) {
  return on_threads(threads, [&] { return GridBuilder(scene, planes).run(params); });
}

}  // namespace raymeter
