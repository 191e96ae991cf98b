#include <algorithm>
#include <limits>

#include <tbb/parallel_for.h>

#include "accel/grid/grid_build.h"
#include "accel/grid/grid_resolution.h"
#include "accel/grid/recursive_grid.h"
#include "core/base/threads.h"

namespace raymeter {

namespace {

/// References of all grids together, at most: this many per primitive and a million, and not more than fits a gigabyte.
constexpr double kReferencesPerPrim = 1024;
constexpr double kMostReferences = 1 << 28;
/// Cells of the outermost grid whose subtrees are built together; a fixed number, so that the order does not depend on threads.
constexpr std::size_t kCellsPerPart = 512;

/// The primitives of cells, by kind: those of kind k in cell c are refs [first[c * kinds + k], first[c * kinds + k + 1]).
struct CellLists {
  std::vector<std::int64_t> first;
  std::vector<std::int32_t> refs;
};

/// One cell's primitives in the arrays of its grid's lists.
struct CellList {
  const std::int64_t* first;
  const std::int32_t* refs;
};

/// Grids, cells and lists that refer to each other by their positions here.
struct Part {
  std::vector<CellLink> top;  ///< links of the outermost grid's cells
  std::vector<NestedGrid> grids;
  std::vector<CellLink> cells;
  std::vector<std::int32_t> first;  ///< [list][kind]
  std::vector<std::int32_t> refs;
  int depth = 0;
};

std::int64_t cell_count(const GridCells& cells) noexcept { return std::int64_t{cells.resolution[0]} * cells.resolution[1] * cells.resolution[2]; }

class NestedBuilder {
public:
  NestedBuilder(const Scene& scene, const UniformGrid& top, const RecursiveGridParams& params)
      : top_(top), levels_(params.levels), max_leaf_size_(params.max_leaf_size) {
    grid_params_.density = params.density;
    grid_params_.rule = params.rule;
    grid_params_.max_resolution = params.max_resolution;
    boxes_.resize(top.kinds.size());
    for (std::size_t k = 0; k < top.kinds.size(); ++k) {
      boxes_[k].resize(top.pools.size(top.kinds[k]));
      for_each_index(boxes_[k].size(),
                     [&](std::size_t i) { boxes_[k][i] = padded_bounds(scene.pools(), scene.prim(top.pools.prim_id(prim_ref(top.kinds[k], i)))); });
      prims_ += static_cast<double>(boxes_[k].size());
    }
  }

  /// The links of the outermost grid's cells [begin, end), and what they lead to.
  [[nodiscard]] Part build(std::size_t begin, std::size_t end) const {
    Part part;
    const std::size_t kinds = boxes_.size();
    const double total = std::min(kReferencesPerPrim * prims_ + (1 << 20), kMostReferences);
    std::vector<std::int64_t> first(kinds + 1);
    std::vector<std::int32_t> refs;
    for (std::size_t c = begin; c < end; ++c) {
      refs.clear();
      for (std::size_t k = 0; k < kinds; ++k) {
        first[k] = static_cast<std::int64_t>(refs.size());
        for (std::int32_t r = top_.first[c * kinds + k]; r < top_.first[c * kinds + k + 1]; ++r) {
          refs.push_back(static_cast<std::int32_t>(top_.refs[static_cast<std::size_t>(r)] & GridRef::kIndexMask));
        }
      }
      first[kinds] = static_cast<std::int64_t>(refs.size());
      const double allowed = total * static_cast<double>(refs.size()) / std::max(1.0, static_cast<double>(top_.refs.size()));
      part.top.push_back(link(part, top_.frame, static_cast<std::int64_t>(c), {first.data(), refs.data()}, 1, allowed));
    }
    return part;
  }

private:
  /// What cell `cell` of a grid is to be; `level` is that of a grid in it. `allowed` is how many references it may lead to.
  CellLink link(Part& part, const GridCells& parent, std::int64_t cell, CellList list, int level, double allowed) const {
    const std::size_t kinds = boxes_.size();
    const std::int64_t count = list.first[kinds] - list.first[0];
    if (count == 0) return {};
    if (count > max_leaf_size_ && level < levels_) {
      GridCells cells = cells_inside(parent, cell, count);
      for (std::int64_t n = cell_count(cells); n > 1; n = cell_count(cells)) {
        const std::int64_t references = count_references(cells, list, allowed);
        if (references >= n * count) break;  // nothing would be told apart
        if (static_cast<double>(references) <= allowed) return CellLink::to_grid(add_grid(part, cells, share_out(cells, list), level, allowed));
        coarsen(cells);
      }
    }
    for (std::size_t k = 0; k < kinds; ++k) {
      part.first.push_back(static_cast<std::int32_t>(part.refs.size()));
      part.refs.insert(part.refs.end(), list.refs + list.first[k], list.refs + list.first[k + 1]);
    }
    return CellLink::to_list(static_cast<std::int32_t>(part.first.size() / kinds) - 1);
  }

  std::int32_t add_grid(Part& part, const GridCells& cells, const CellLists& lists, int level, double allowed) const {
    const std::size_t kinds = boxes_.size();
    const auto grid = part.grids.size();
    const auto first_cell = part.cells.size();
    const auto n = static_cast<std::size_t>(cell_count(cells));
    part.grids.push_back({cells, static_cast<std::int32_t>(first_cell)});
    part.cells.resize(first_cell + n);
    part.depth = std::max(part.depth, level);
    for (std::size_t c = 0; c < n; ++c) {
      const CellList list{lists.first.data() + c * kinds, lists.refs.data()};
      const double share = static_cast<double>(list.first[kinds] - list.first[0]) / static_cast<double>(lists.refs.size());
      const CellLink inner = link(part, cells, static_cast<std::int64_t>(c), list, level + 1, allowed * share);
      part.cells[first_cell + c] = inner;  // the vector may have moved
    }
    return static_cast<std::int32_t>(grid);
  }

  /// The cells of a grid for `count` primitives in a cell. Its planes are those of floats, as the traversal computes them.
  [[nodiscard]] GridCells cells_inside(const GridCells& parent, std::int64_t cell, std::int64_t count) const {
    GridCells cells{};
    glm::dvec3 extent(0.0);
    for (std::size_t a = 0; a < 3; ++a) {
      const auto index = static_cast<float>(cell % parent.resolution[a]);
      cell /= parent.resolution[a];
      const float low = grid_plane(index, parent.cell_size[a], parent.origin[a]), high = grid_plane(index + 1, parent.cell_size[a], parent.origin[a]);
      cells.origin[a] = low;
      extent[static_cast<glm::length_t>(a)] = std::max(0.0, double{high} - double{low});
    }
    const GridResolution wanted = grid_resolution(grid_params_, extent, count);
    for (std::size_t a = 0; a < 3; ++a) {
      const double size = extent[static_cast<glm::length_t>(a)];
      const double most = top_.finest_cell[a] > 0 ? std::max(1.0, size / top_.finest_cell[a]) : 1.0;
      cells.resolution[a] = std::min(wanted[a], static_cast<std::int32_t>(std::min(most, 65535.0)));
      set_size(cells, a, size);
    }
    return cells;
  }
  static void set_size(GridCells& cells, std::size_t a, double extent) noexcept {
    const double size = extent / cells.resolution[a];
    cells.cell_size[a] = static_cast<float>(size);
    cells.inv_cell_size[a] = cells.resolution[a] > 1 ? static_cast<float>(1 / size) : 0.0f;
  }
  static void coarsen(GridCells& cells) noexcept {
    for (std::size_t a = 0; a < 3; ++a) {
      const double extent = double{cells.cell_size[a]} * cells.resolution[a];
      cells.resolution[a] = (cells.resolution[a] + 1) / 2;
      set_size(cells, a, extent);
    }
  }

  template <class Body>
  void for_each_box(const CellList& list, Body&& body) const {
    for (std::size_t k = 0; k < boxes_.size(); ++k) {
      for (std::int64_t r = list.first[k]; r < list.first[k + 1]; ++r) body(k, list.refs[r], boxes_[k][static_cast<std::size_t>(list.refs[r])]);
    }
  }
  [[nodiscard]] std::int64_t count_references(const GridCells& cells, const CellList& list, double enough) const {
    std::int64_t sum = 0;
    for_each_box(list, [&](std::size_t, std::int32_t, const Aabb& box) {
      if (static_cast<double>(sum) <= enough) sum += cells_of(cells, top_.margin, box).count();
    });
    return sum;
  }
  /// A counting sort by cell and kind.
  [[nodiscard]] CellLists share_out(const GridCells& cells, const CellList& list) const {
    const std::size_t kinds = boxes_.size();
    CellLists lists;
    lists.first.resize(static_cast<std::size_t>(cell_count(cells)) * kinds + 1);
    const auto for_each_slot = [&](auto&& body) {
      for_each_box(list, [&](std::size_t k, std::int32_t ref, const Aabb& box) {
        const CellRange range = cells_of(cells, top_.margin, box);
        for (std::size_t z = range.low[2]; z <= range.high[2]; ++z) {
          for (std::size_t y = range.low[1]; y <= range.high[1]; ++y) {
            const std::size_t row = (z * static_cast<std::size_t>(cells.resolution[1]) + y) * static_cast<std::size_t>(cells.resolution[0]);
            for (std::size_t x = range.low[0]; x <= range.high[0]; ++x) body((row + x) * kinds + k, ref);
          }
        }
      });
    };
    for_each_slot([&](std::size_t slot, std::int32_t) { ++lists.first[slot + 1]; });
    for (std::size_t slot = 1; slot < lists.first.size(); ++slot) lists.first[slot] += lists.first[slot - 1];
    lists.refs.resize(static_cast<std::size_t>(lists.first.back()));
    std::vector<std::int64_t> next(lists.first.begin(), lists.first.end() - 1);
    for_each_slot([&](std::size_t slot, std::int32_t ref) { lists.refs[static_cast<std::size_t>(next[slot]++)] = ref; });
    return lists;
  }

  const UniformGrid& top_;
  GridParams grid_params_;
  int levels_;
  int max_leaf_size_;
  double prims_ = 0;
  std::vector<std::vector<Aabb>> boxes_;  ///< padded, per kind
};

/// Puts the parts behind each other.
void join(const std::vector<Part>& parts, std::size_t kinds, RecursiveGrid& out) {
  std::int64_t grids = 1, cells = 0, lists = 0, refs = 0;
  for (const Part& part : parts) cells += static_cast<std::int64_t>(part.top.size());
  for (const Part& part : parts) {
    const auto moved = [&](CellLink link) {
      if (link.is_empty()) return link;
      return link.is_grid() ? CellLink::to_grid(link.grid() + static_cast<std::int32_t>(grids))
                            : CellLink::to_list(link.list() + static_cast<std::int32_t>(lists));
    };
    for (const CellLink link : part.top) out.cells.push_back(moved(link));
    grids += static_cast<std::int64_t>(part.grids.size());
    cells += static_cast<std::int64_t>(part.cells.size());
    lists += static_cast<std::int64_t>(part.first.size() / kinds);
    refs += static_cast<std::int64_t>(part.refs.size());
  }
  if (std::max({grids, cells, lists * static_cast<std::int64_t>(kinds), refs}) >= std::numeric_limits<std::int32_t>::max()) {
    throw Error("levels: the grids have " + std::to_string(cells) + " cells and " + std::to_string(refs) + " references; expected less than 2^31");
  }
  std::int32_t grid_offset = 1, list_offset = 0;
  for (const Part& part : parts) {
    const auto cell_offset = static_cast<std::int32_t>(out.cells.size()), ref_offset = static_cast<std::int32_t>(out.refs.size());
    for (NestedGrid grid : part.grids) {
      grid.first_cell += cell_offset;
      out.grids.push_back(grid);
    }
    for (const CellLink link : part.cells) {
      out.cells.push_back(link.is_empty()  ? link
                          : link.is_grid() ? CellLink::to_grid(link.grid() + grid_offset)
                                           : CellLink::to_list(link.list() + list_offset));
    }
    for (const std::int32_t first : part.first) out.first.push_back(first + ref_offset);
    for (const std::int32_t ref : part.refs) out.refs.push_back(ref);
    grid_offset += static_cast<std::int32_t>(part.grids.size());
    list_offset += static_cast<std::int32_t>(part.first.size() / kinds);
    out.depth = std::max(out.depth, part.depth);
  }
  out.first.push_back(static_cast<std::int32_t>(out.refs.size()));
}

}  // namespace

RecursiveGrid build_nested_grids(const Scene& scene, const RecursiveGridParams& params, int threads) {
  GridParams top_params;
  top_params.density = params.top_density;
  top_params.rule = params.rule;
  top_params.max_resolution = params.max_resolution;
  top_params.touching = params.touching;
  return on_threads(threads, [&] {
    UniformGrid top = build_uniform_grid(scene, top_params, threads, GridPlanes::inside_too);
    RecursiveGrid out;
    out.frame = top.frame;
    out.kinds = top.kinds;
    out.grids.push_back({top.frame, 0});
    const auto cells = static_cast<std::size_t>(top.cell_count());
    const NestedBuilder builder(scene, top, params);
    std::vector<Part> parts((cells + kCellsPerPart - 1) / kCellsPerPart);
    tbb::parallel_for(std::size_t{0}, parts.size(),
                      [&](std::size_t p) { parts[p] = builder.build(p * kCellsPerPart, std::min(cells, (p + 1) * kCellsPerPart)); });
    join(parts, top.kinds.size(), out);
    out.pools = std::move(top.pools);
    return out;
  });
}

}  // namespace raymeter
