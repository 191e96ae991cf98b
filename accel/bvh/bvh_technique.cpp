#include "accel/bvh/bvh.h"
#include "accel/bvh/bvh_structure.h"
#include "accel/bvh/tree_quality.h"

namespace raymeter {

ParamValues resolve_bvh(const ParamValues& values) {
  const auto params = bind<BvhParams>(values);
  check_volume(params.volume, params);
  check_tree_params(params);
  return resolved(params);
}

std::unique_ptr<Structure> build_bvh(const Scene& scene, const ParamValues& values, int threads) {
  const auto params = bind<BvhParams>(values);
  const BvhTree tree = build_bvh_tree(scene, params, threads);
  return with_volume(params.volume, params, scene,
                     [&]<class V>(const V& volume) -> std::unique_ptr<Structure> { return std::make_unique<BvhStructure<V>>(scene, tree, volume, threads); });
}

void add_bvh_quality(const Scene& scene, const ParamValues& values, int threads, BuildStats& stats) {
  // The layout does not keep the tree.
  add_tree_quality(scene, build_bvh_tree(scene, bind<BvhParams>(values), threads), threads, stats);
}

}  // namespace raymeter
