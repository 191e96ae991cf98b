#pragma once

#include <array>

#include "accel/technique.h"

namespace raymeter {

inline constexpr int kMostCostPlanes = 64;

struct OctreeParams {
  int max_depth = 12;
  int leaf_size = 8;
  double least_cell = 16;
  std::string split = "center";
  int cost_count = 10;
  std::string cost_planes = "between";
  std::string cost_median = "parts";
  std::string cost_middle = "upper";
  std::string cost_measure = "area";
  std::string cost_counts = "boxes";
  std::string placement = "exact";
  std::string root = "box";
  double growth = 0.001;
  double cone_padding = 0;
  double thin_padding = 0;
  std::string padding_sides = "both";
  int budget = 32;
  std::string tracking = "parametric";
  std::string start = "t_min";
  std::string blocker = "first";
  bool mailbox = false;

  static auto fields() {
    using Field = Param<OctreeParams>;
    constexpr auto by_cost = [](const OctreeParams& p) { return p.split == "cost"; };
    return std::array{
        Field{"max_depth", &OctreeParams::max_depth, "levels below the root at most", 0, 20},
        Field{"leaf_size", &OctreeParams::leaf_size, "a cell of so many primitives is not divided", 1, 64},
        Field{"least_cell", &OctreeParams::least_cell, "axes of cells are divided that are so many times as long as lists reach beyond cells, or longer", 0.5,
              1e6},
        Field{"split", &OctreeParams::split, "where cells are divided: in the middle, or where each axis expects the least cost", 0, 0, {"center", "cost"}},
        where<OctreeParams>(by_cost, Field{"cost_count", &OctreeParams::cost_count, "planes that are tried on an axis", 1, kMostCostPlanes}),
        where<OctreeParams>(by_cost, Field{"cost_planes",
                                           &OctreeParams::cost_planes,
                                           "planes are tried between the cell's middle and the objects' median, or with these ends",
                                           0,
                                           0,
                                           {"between", "ends"}}),
        where<OctreeParams>(by_cost, Field{"cost_median",
                                           &OctreeParams::cost_median,
                                           "objects stand in their median where their boxes have their centres, or the boxes' parts in the cell",
                                           0,
                                           0,
                                           {"parts", "boxes"}}),
        where<OctreeParams>(by_cost,
                            Field{"cost_middle",
                                  &OctreeParams::cost_middle,
                                  "the median of an even number: the upper one of the two in the middle, or their mean; or for any median the mean of all",
                                  0,
                                  0,
                                  {"upper", "mean", "mean_of_all"}}),
        where<OctreeParams>(by_cost, Field{"cost_measure",
                                           &OctreeParams::cost_measure,
                                           "what the objects on a side are weighted with: its area, or its length",
                                           0,
                                           0,
                                           {"area", "length"}}),
        where<OctreeParams>(by_cost, Field{"cost_counts",
                                           &OctreeParams::cost_counts,
                                           "an object counts on each side that its box touches, or on that of its box's centre",
                                           0,
                                           0,
                                           {"boxes", "centers"}}),
        Field{"placement",
              &OctreeParams::placement,
              "cells that list a primitive: those that it touches itself, or those that its box touches",
              0,
              0,
              {"exact", "box"}},
        Field{"root", &OctreeParams::root, "shape of the root cell: the scene's box, or the cube around it", 0, 0, {"box", "cube"}},
        Field{"growth", &OctreeParams::growth, "of the root cell beyond the scene's box, relative to its extent", 0, 1},
        where<OctreeParams>([](const OctreeParams& p) { return p.placement == "box"; },
                            Field{"cone_padding", &OctreeParams::cone_padding, "of the boxes of cones and cylinders, in units of the scene", 0, 1e6}),
        where<OctreeParams>([](const OctreeParams& p) { return p.placement == "box" && p.cone_padding > 0; },
                            Field{"padding_sides",
                                  &OctreeParams::padding_sides,
                                  "sides of boxes of cones and cylinders that are padded: all, or the low ones",
                                  0,
                                  0,
                                  {"both", "low"}}),
        where<OctreeParams>([](const OctreeParams& p) { return p.placement == "box"; },
                            Field{"thin_padding", &OctreeParams::thin_padding,
                                  "of the boxes of triangles and polygons, along axes where they are no longer than this; in units of the scene", 0, 1e6}),
        Field{"budget", &OctreeParams::budget, "references per primitive at most; small scenes get those of 1024", 1, 65536},
        Field{"tracking", &OctreeParams::tracking, "how a ray finds its next cell", 0, 0, {"parametric", "point_location", "neighbour"}, ParamUse::query},
        Field{"start",
              &OctreeParams::start,
              "where a ray begins to walk: at its t_min, or at its origin as programs do that only leave out near hits",
              0,
              0,
              {"t_min", "origin"},
              ParamUse::query},
        Field{"blocker",
              &OctreeParams::blocker,
              "where a ray that asks for any hit ends: at the first that is found, or at the nearest",
              0,
              0,
              {"first", "nearest"},
              ParamUse::query},
        Field{"mailbox", &OctreeParams::mailbox, "a packet remembers its latest tests", 0, 0, {}, ParamUse::query},
    };
  }
};

[[nodiscard]] std::unique_ptr<Structure> build_octree(const Scene& scene, const ParamValues& values, int threads);

inline constexpr StructureEntry kOctreeEntry{"octree",
                                             "octree, tracked from the root, by neighbours or by the ray's parameter",
                                             "Glassner 1984; Samet 1989; Gargantini, Atkinson 1993; Revelles et al. 2000",
                                             param_infos<OctreeParams>,
                                             resolve_params<OctreeParams>,
                                             build_octree};

}  // namespace raymeter
