#pragma once

#include <array>

#include "accel/grid/grid_layout.h"
#include "accel/technique.h"

namespace raymeter {

/// The forms of the DDA (dda_form_kernel.h) and what they are called, the default first.
struct NamedDdaForm {
  std::string_view name;
  DdaForm form;
};
inline constexpr std::array<NamedDdaForm, 5> kDdaForms{{{"recompute", DdaForm::recompute},
                                                        {"divide", DdaForm::divide},
                                                        {"fma", DdaForm::fma},
                                                        {"accumulate", DdaForm::accumulate},
                                                        {"compensated", DdaForm::compensated}}};

struct GridParams {
  double density = 4.0;
  std::string rule = "cubic";
  std::string resolution = "auto";
  int max_resolution = 4096;
  std::string touching = "begin";
  double growth_low = 0;
  double growth_high = 0;
  double cone_padding = 0;
  double thin_padding = 0;
  double margin = 1.0 / 512;
  bool mailbox = true;
  std::string traversal = "lanes";
  std::string dda{kDdaForms.front().name};
  std::string start = "t_min";
  std::string blocker = "first";

  static auto fields() {
    using Field = Param<GridParams>;
    std::vector<std::string_view> forms;
    for (const NamedDdaForm& one : kDdaForms) forms.push_back(one.name);
    constexpr auto automatic = [](const GridParams& p) { return p.resolution == "auto"; };
    return std::array{
        where<GridParams>(automatic, Field{"density", &GridParams::density, "cells per primitive", 0.01, 64}),
        where<GridParams>(automatic, Field{"rule", &GridParams::rule, "how density becomes a resolution", 0, 0, {"cubic", "woo", "customary"}}),
        Field{"resolution", &GridParams::resolution, "cells on each axis as NXxNYxNZ, or auto: by rule and density"},
        where<GridParams>(automatic, Field{"max_resolution", &GridParams::max_resolution, "cells on an axis at most, where resolution is auto", 1, 65535}),
        Field{"touching",
              &GridParams::touching,
              "boxes that are listed on both sides of a plane which they touch: those that begin there, that end there, or all",
              0,
              0,
              {"begin", "end", "all"}},
        Field{"growth_low", &GridParams::growth_low, "of the grid beyond the low sides of the scene's box, relative to its extent", 0, 1},
        Field{"growth_high", &GridParams::growth_high, "of the grid beyond the high sides of the scene's box, relative to its extent", 0, 1},
        Field{"cone_padding", &GridParams::cone_padding, "of the boxes of cones and cylinders on all sides, in units of the scene", 0, 1e6},
        Field{"thin_padding", &GridParams::thin_padding,
              "of the boxes of triangles and polygons, along axes where they are no longer than this; in units of the scene", 0, 1e6},
        Field{"margin", &GridParams::margin, "share of a cell that its list reaches beyond it at least; rays from far away need more", 0, 0.25},
        Field{"mailbox", &GridParams::mailbox, "test hardly any primitive twice for one ray", 0, 0, {}, ParamUse::query},
        Field{"traversal", &GridParams::traversal, "lanes step each on its own, or packets go slice by slice", 0, 0, {"lanes", "slices"}, ParamUse::query},
        where<GridParams>(
            [](const GridParams& p) { return p.traversal == "lanes"; },
            Field{"dda", &GridParams::dda, "where the next plane's t comes from: its index (recompute and divide, which lose nothing; fma) or a sum of steps",
                  0, 0, forms, ParamUse::query}),
        where<GridParams>([](const GridParams& p) { return p.traversal == "lanes"; },
                          Field{"start",
                                &GridParams::start,
                                "where a ray begins to walk: at its t_min, or at its origin as programs do that only leave out near hits",
                                0,
                                0,
                                {"t_min", "origin"},
                                ParamUse::query}),
        where<GridParams>([](const GridParams& p) { return p.traversal == "lanes"; },
                          Field{"blocker",
                                &GridParams::blocker,
                                "where a ray that asks for any hit ends: at the first that is found, or at the nearest",
                                0,
                                0,
                                {"first", "nearest"},
                                ParamUse::query}),
    };
  }
};

[[nodiscard]] std::unique_ptr<Structure> build_grid(const Scene& scene, const ParamValues& values, int threads);

inline constexpr StructureEntry kGridEntry{"grid",
                                           "uniform grid, traversed cell by cell (3D-DDA)",
                                           "Fujimoto, Tanaka, Iwata 1986; Amanatides, Woo 1987; Cleary, Wyvill 1988",
                                           param_infos<GridParams>,
                                           resolve_params<GridParams>,
                                           build_grid,
                                           nullptr,
                                           false,
                                           nullptr,
                                           [](const ParamValues& values) { return bind<GridParams>(values).traversal == "lanes"; }};

}  // namespace raymeter
