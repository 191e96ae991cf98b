#pragma once

#include <vector>

#include "accel/bvh/builders.h"
#include "accel/bvh/bvh_params.h"
#include "accel/technique.h"
#include "accel/volumes.h"

namespace raymeter {

struct BvhParams : SahParams, GoldsmithSalmonParams, SbvhParams, PlocParams, TreeParams, VolumeParams {
  std::string volume = "aabb";
  std::string builder = "binned_sah";
  std::string traversal = "packet";

  static auto fields() {
    using Field = Param<BvhParams>;
    std::vector<Field> fields{
        {"volume", &BvhParams::volume, "bounding volume of a node", 0, 0, {"aabb", "sphere", "obb", "kdop"}},
        {"builder", &BvhParams::builder, "how the hierarchy is built", 0, 0, bvh_builder_names()},
        {"traversal", &BvhParams::traversal, "how rays go through it", 0, 0, {"packet", "heap", "beam"}},
        {"bins", &BvhParams::bins, "binned_sah: bins per axis, where a node has at least that many primitives", 2, 64},
        {"max_leaf_size", &BvhParams::max_leaf_size, "surface area heuristic: larger leaves are split even where that costs more; beam: but for leaves of triangles", 1, 64},
        {"node_cost", &BvhParams::node_cost, "surface area heuristic: cost of a node in primitive tests", 0.01, 100},
        {"insertion_order",
         &BvhParams::insertion_order,
         "goldsmith_salmon: as in the scene, along its longest axis, at random, or the cheapest tree of `shuffles` random orders",
         0,
         0,
         {"file", "sorted", "shuffled", "best"}},
        {"insertion_seed", &BvhParams::insertion_seed, "goldsmith_salmon: of the first random order", 0, 1000000},
        {"shuffles", &BvhParams::shuffles, "goldsmith_salmon: random orders tried by insertion_order=best", 1, 1000},
        {"inherited", &BvhParams::inherited, "goldsmith_salmon: a place's cost includes the growth of the nodes above it"},
        {"leaf_boxes", &BvhParams::leaf_boxes, "goldsmith_salmon: primitives have boxes of their own; off: those under a node are tested once it is opened"},
        {"split_overlap", &BvhParams::split_overlap, "sbvh: planes are tried where children overlap by more than this share of the root's area", 0, 1},
        {"split_budget", &BvhParams::split_budget, "sbvh: most references beyond one a primitive, relative to the primitives", 0, 8},
        {"ploc_radius", &BvhParams::ploc_radius, "ploc: how far away in the order a cluster looks for a partner", 1, 1000},
        {"reinsertion", &BvhParams::reinsertion, "rounds in which subtrees of the binary tree are moved to better places", 0, 1000},
        {"width", &BvhParams::width, "most children of a node, by opening nodes and grouping children; 0: as built", 0, 64},
    };
    const std::vector<Field> volume = volume_fields<BvhParams>();
    fields.insert(fields.end(), volume.begin(), volume.end());
    return fields;
  }
};

/// All parameters with their values; throws Error also where those of the volume contradict each other.
[[nodiscard]] ParamValues resolve_bvh(const ParamValues& values);
[[nodiscard]] std::unique_ptr<Structure> build_bvh(const Scene& scene, const ParamValues& values, int threads);
/// Builds once more to look at the tree.
void add_bvh_quality(const Scene& scene, const ParamValues& values, int threads, BuildStats& stats);

inline constexpr StructureEntry kBvhEntry{"bvh",
                                          "bounding volume hierarchy: volume x builder x traversal",
                                          "Rubin, Whitted 1980; Goldsmith, Salmon 1987; Wald 2007 (binned SAH)",
                                          param_infos<BvhParams>,
                                          resolve_bvh,
                                          build_bvh,
                                          add_bvh_quality};

}  // namespace raymeter
