#include "accel/bvh/bvh.h"
#include "accel/bvh/bvh_structure.h"
#include "accel/bvh/quantised_bvh.h"
#include "accel/bvh/quantised_nodes.h"
#include "accel/bvh/weak_bvh.h"
#include "accel/bvh/wide_bvh.h"
#include "accel/bvh/wide_quality.h"
#include "core/base/threads.h"

namespace raymeter {

namespace {

/// Asks for what only packets through nodes of their own have.
bool needs_packets(const BvhParams& params) { return params.volume != "aabb" || params.width != 0 || has_weak_tests(params); }

}  // namespace

ParamValues resolve_bvh(const ParamValues& values) {
  auto params = bind<BvhParams>(values);
  check_volume(params.volume, params);
  check_tree_params(params);
  if (params.traversal == "auto" && needs_packets(params)) params.traversal = "packet";
  if (params.box_test == "fma" && params.reciprocal == "none") throw Error("reciprocal: box_test=fma multiplies by one, got none");
  if (params.is_wide()) {
    if (params.volume != "aabb") throw Error("traversal: " + params.traversal + " needs volume=aabb, got " + params.volume);
    if (params.group % kBeamRays != 0) throw Error("group: expected a multiple of " + std::to_string(kBeamRays) + ", got " + std::to_string(params.group));
    if (params.width != 0) throw Error("width: traversal=" + params.traversal + " has nodes of its own, of 8 children; expected 0");
  }
  return resolved(params);
}

std::unique_ptr<Structure> build_bvh(const Scene& scene, const ParamValues& values, int threads) {
  const auto params = bind<BvhParams>(values);
  return on_threads(threads, [&]() -> std::unique_ptr<Structure> {  // one arena for all that follows
    BvhTree tree = build_bvh_tree(scene, params, threads);
    if (params.plane_bits != kFloatPlanes)
      return make_quantised_bvh(scene, make_wide_tree(scene, std::move(tree), params.max_leaf_size, threads), params.plane_bits);
    if (params.is_wide()) return build_wide_bvh(scene, std::move(tree), params.max_leaf_size, threads);
    return with_volume(params.volume, params, scene, [&]<class V>(const V& volume) -> std::unique_ptr<Structure> {
      return std::make_unique<BvhStructure<V>>(scene, tree, volume, threads, params);
    });
  });
}

void add_bvh_quality(const Scene& scene, const ParamValues& values, int threads, BuildStats& stats) {
  const auto params = bind<BvhParams>(values);
  // The layout does not keep the tree.
  BvhTree tree = build_bvh_tree(scene, params, threads);
  if (params.is_wide()) {
    WideTree wide = make_wide_tree(scene, std::move(tree), params.max_leaf_size, threads);
    if (params.plane_bits != kFloatPlanes) round_outwards({wide.nodes.data(), wide.nodes.size()}, params.plane_bits);
    tree = plain_tree(scene, wide);
  }
  add_box_quality(scene, tree, threads, stats);
  with_volume(params.volume, params, scene, [&](const auto& volume) { add_volume_quality(tree, node_measures(volume, scene, tree, threads), stats); });
}

}  // namespace raymeter
