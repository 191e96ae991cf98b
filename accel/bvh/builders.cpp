#include "accel/bvh/builders.h"

#include <algorithm>
#include <array>

#include "accel/bvh/box_builders.h"
#include "accel/bvh/bvh.h"
#include "accel/bvh/collapse.h"
#include "accel/bvh/goldsmith_salmon.h"
#include "accel/bvh/reinsertion.h"
#include "core/base/error.h"

namespace raymeter {

namespace {

/// Hands a builder the groups of parameters that it takes: BvhParams is each of them.
template <auto kBuild>
BvhTree build_with(const Scene& scene, const BvhParams& params, int threads) {
  if constexpr (requires { kBuild(scene, params, threads); }) {
    return kBuild(scene, params, threads);
  } else {
    return kBuild(scene, params, params, threads);
  }
}

/// A tree that is still to be changed is to have all of its leaves.
BvhTree build_with_binned_sah(const Scene& scene, const BvhParams& params, int threads) {
  return build_binned_sah(scene, params, threads, params.is_wide() && params.reinsertion == 0 ? LeafUse::for_blocks : LeafUse::as_they_are);
}

/// By the areas of the volume in use.
BvhTree build_with_goldsmith_salmon(const Scene& scene, const BvhParams& params, int threads) {
  return with_volume(params.volume, params, scene, [&](const auto& volume) { return build_goldsmith_salmon(scene, volume, params, threads); });
}

// THE table of builders: a new one is one file and one row.
constexpr std::array kBuilders{
    BvhBuilder{"binned_sah", build_with_binned_sah}, BvhBuilder{"sweep_sah", build_with<build_sweep_sah>},
    BvhBuilder{"sbvh", build_with<build_sbvh>},      BvhBuilder{"goldsmith_salmon", build_with_goldsmith_salmon},
    BvhBuilder{"lbvh", build_with<build_lbvh>},      BvhBuilder{"ploc", build_with<build_ploc>},
};

}  // namespace

std::vector<std::string_view> bvh_builder_names() {
  std::vector<std::string_view> names;
  for (const BvhBuilder& builder : kBuilders) names.push_back(builder.name);
  return names;
}

void check_tree_params(const TreeParams& params) {
  if (params.width == 1) throw Error("width: expected 0 or a whole number from 2 to 64, got 1");
}

BvhTree build_bvh_tree(const Scene& scene, const BvhParams& params, int threads) {
  check_tree_params(params);
  const auto* const builder = std::find_if(kBuilders.begin(), kBuilders.end(), [&](const BvhBuilder& row) { return row.name == params.builder; });
  BvhTree tree = builder->build(scene, params, threads);
  if (params.reinsertion > 0) tree = reinserted(with_width(tree, 2, threads), params.reinsertion, threads);
  if (params.width > 0) tree = with_width(tree, params.width, threads);
  return tree;
}

}  // namespace raymeter
