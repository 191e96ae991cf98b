#include "accel/bvh/builders.h"

#include <algorithm>
#include <array>

#include "accel/bvh/box_builders.h"
#include "accel/bvh/bvh.h"
#include "accel/bvh/collapse.h"
#include "accel/bvh/goldsmith_salmon.h"
#include "core/base/error.h"
#include "core/bounds/aabb_volume.h"

namespace raymeter {

namespace {

template <auto kBuild>
BvhTree build_with(const Scene& scene, const BvhParams& params, int threads) {
  return kBuild(scene, params, threads);
}
BvhTree build_with_goldsmith_salmon(const Scene& scene, const BvhParams& params, int threads) {
  return build_goldsmith_salmon(scene, AabbVolume(), params, threads);
}
// THE table of builders: a new one is one file and one row.
constexpr std::array kBuilders{
    BvhBuilder{"binned_sah", build_with<build_binned_sah>},
    BvhBuilder{"sweep_sah", build_with<build_sweep_sah>},
    BvhBuilder{"goldsmith_salmon", build_with_goldsmith_salmon},
};

}  // namespace

std::vector<std::string_view> bvh_builder_names() {
  std::vector<std::string_view> names;
  for (const BvhBuilder& builder : kBuilders) names.push_back(builder.name);
  return names;
}

BvhTree build_bvh_tree(const Scene& scene, const BvhParams& params, int threads) {
  if (params.width == 1) throw Error("width: expected 0 or a whole number from 2 to 64, got 1");
  const auto* const builder = std::find_if(kBuilders.begin(), kBuilders.end(), [&](const BvhBuilder& row) { return row.name == params.builder; });
  BvhTree tree = builder->build(scene, params, threads);
  if (params.width > 0) tree = with_width(tree, params.width, threads);
  return tree;
}

}  // namespace raymeter
