#pragma once

#include <vector>

#include "accel/technique.h"

namespace raymeter {

/// What both ways of placing planes share.
struct KdParams {
  int max_depth = 0;
  int leaf_size = 1;
  bool clip = true;
  double reference_budget = 32;
  std::string traversal = "frustum";
  bool mailbox = true;
};

struct KdTreeParams : KdParams {
  double traversal_cost = 2;
  double intersection_cost = 1;
  double empty_bonus = 0.2;

  static std::vector<Param<KdTreeParams>> fields();
};

/// Depth and leaf size by default as in the published comparison of Havran, Prikryl and Purgathofer 2000.
struct BspParams : KdParams {
  BspParams() {
    max_depth = 16;
    leaf_size = 2;
  }
  static std::vector<Param<BspParams>> fields();
};

[[nodiscard]] std::unique_ptr<Structure> build_kdtree(const Scene& scene, const ParamValues& values, int threads);
[[nodiscard]] std::unique_ptr<Structure> build_bsp(const Scene& scene, const ParamValues& values, int threads);

inline constexpr StructureEntry kKdTreeEntry{"kdtree",
                                             "k-d tree by the surface area heuristic, with split clipping",
                                             "Bentley 1975; MacDonald, Booth 1990; Havran 2000; Wald, Havran 2006",
                                             param_infos<KdTreeParams>,
                                             resolve_params<KdTreeParams>,
                                             build_kdtree};
inline constexpr StructureEntry kBspEntry{
    "bsp", "BSP tree: cells halved on the axes in turn", "Kaplan 1985; Sung, Shirley 1992", param_infos<BspParams>, resolve_params<BspParams>, build_bsp};

}  // namespace raymeter
