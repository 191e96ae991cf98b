#pragma once

#include <array>

#include "accel/grid/recursive_grid_layout.h"
#include "accel/technique.h"
#include "core/base/column.h"
#include "core/scene/pools.h"

namespace raymeter {

struct RecursiveGridParams {
  double density = 1.0;
  double top_density = 0.125;
  std::string rule = "cubic";
  int levels = 2;
  int max_leaf_size = 8;
  int max_resolution = 1024;
  std::string touching = "begin";
  bool mailbox = true;
  std::string start = "t_min";

  static auto fields() {
    using Field = Param<RecursiveGridParams>;
    return std::array{
        Field{"density", &RecursiveGridParams::density, "cells per primitive of a grid in a cell", 0.01, 64},
        Field{"top_density", &RecursiveGridParams::top_density, "cells per primitive of the outermost grid", 0.001, 64},
        Field{"rule", &RecursiveGridParams::rule, "how density becomes a resolution", 0, 0, {"cubic", "woo", "customary"}},
        Field{"levels", &RecursiveGridParams::levels, "grids inside each other: 1 is a uniform grid, 2 a two-level grid", 1, kMaxGridLevels},
        Field{"max_leaf_size", &RecursiveGridParams::max_leaf_size, "a cell with more primitives becomes a grid", 1, 1000000},
        Field{"max_resolution", &RecursiveGridParams::max_resolution, "cells on an axis of a grid at most", 1, 65535},
        Field{"touching",
              &RecursiveGridParams::touching,
              "boxes that are listed on both sides of a plane which they touch: those that begin there, that end there, or all",
              0,
              0,
              {"begin", "end", "all"}},
        Field{"mailbox",
              &RecursiveGridParams::mailbox,
              "remember what rays were tested against, so that hardly any primitive is tested twice",
              0,
              0,
              {},
              ParamUse::query},
        Field{"start",
              &RecursiveGridParams::start,
              "where a ray begins to walk: at its t_min, or at its origin as programs do that only leave out near hits",
              0,
              0,
              {"t_min", "origin"},
              ParamUse::query},
    };
  }
};

/// Built grids in cells of grids: see RecursiveGridView for what the columns hold.
struct RecursiveGrid {
  GridFrame frame{};
  std::vector<PrimKind> kinds;
  Pools pools;
  Column<NestedGrid> grids;
  Column<CellLink> cells;
  Column<std::int32_t> first;
  Column<std::int32_t> refs;
  int depth = 0;  ///< of the deepest grid, 0 for the outermost

  [[nodiscard]] RecursiveGridView view(bool mailbox, bool from_origin) const noexcept;
};

/// Builds a uniform grid and, in each cell of more than max_leaf_size primitives, another one, down to `levels` of them. The same on any number of threads (0:
/// all). A cell stays as it is where each cell of its grid would list all that it lists; its grid is made coarser where its references would outgrow a bound on
/// the sum of all: many primitives in one place would else fill the memory. Throws Error where the outermost grid cannot be numbered with 32 bits.
[[nodiscard]] RecursiveGrid build_nested_grids(const Scene& scene, const RecursiveGridParams& params, int threads);

[[nodiscard]] std::unique_ptr<Structure> build_recursive_grid(const Scene& scene, const ParamValues& values, int threads);

inline constexpr StructureEntry kRecursiveGridEntry{"recursive_grid",
                                                    "grids inside the full cells of grids",
                                                    "Jevans, Wyvill 1989; two levels: Kalojanov, Billeter, Slusallek 2011",
                                                    param_infos<RecursiveGridParams>,
                                                    resolve_params<RecursiveGridParams>,
                                                    build_recursive_grid};

}  // namespace raymeter
