#pragma once

#include <array>

#include "accel/technique.h"

namespace raymeter {

struct BvhParams {
  std::string volume = "aabb";
  std::string builder = "binned_sah";
  std::string traversal = "packet";
  int bins = 32;
  int max_leaf_size = 8;
  double node_cost = 1.0;

  static auto fields() {
    using Field = Param<BvhParams>;
    return std::array{
        Field{"volume", &BvhParams::volume, "bounding volume of a node", 0, 0, {"aabb"}},
        Field{"builder", &BvhParams::builder, "how the hierarchy is built", 0, 0, {"binned_sah"}},
        Field{"traversal", &BvhParams::traversal, "how rays go through it", 0, 0, {"packet"}, ParamUse::query},
        Field{"bins", &BvhParams::bins, "bins per axis, where a node has at least that many primitives", 2, 64},
        Field{"max_leaf_size", &BvhParams::max_leaf_size, "larger leaves are split even where that costs more", 1, 64},
        Field{"node_cost", &BvhParams::node_cost, "surface area heuristic: cost of a node in primitive tests", 0.01, 100},
    };
  }
};

[[nodiscard]] std::unique_ptr<Structure> build_bvh(const Scene& scene, const ParamValues& values, int threads);

inline constexpr StructureEntry kBvhEntry{"bvh", "bounding volume hierarchy, traversed by packets front to back",
                                          "Rubin, Whitted 1980; Goldsmith, Salmon 1987; Wald 2007 (binned SAH)", param_infos<BvhParams>,
                                          resolve_params<BvhParams>, build_bvh};

}  // namespace raymeter
