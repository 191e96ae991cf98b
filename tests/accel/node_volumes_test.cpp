// The volumes of a tree's nodes hold what is below, in exact arithmetic.

#include <gtest/gtest.h>

#include <atomic>

#include "accel/bvh/bvh_structure.h"
#include "accel/registry.h"
#include "experiments/scenes/generators.h"
#include "tests/support/exact_volumes.h"

namespace raymeter {
namespace {

using test::error_for;
using test::Exact;
using test::holds;
using test::operator+;
using test::Random;
using test::surface_point;

/// Every node's volume holds what is below it, in trees of two shapes.
template <class V>
void expect_ancestors_hold(const V& volume, const Scene& scene) {
  Random random(33);
  for (const char* technique : {"bvh:builder=binned_sah", "bvh:builder=goldsmith_salmon"}) {
    const BvhTree tree = build_bvh_tree(scene, raymeter::bind<BvhParams>(parse_technique(technique).params), 1);
    const FlatTree flat = flatten(tree);
    const auto bounds = link_bounds(volume, scene, tree, flat, false, 1);
    for (std::size_t i = 0; i < bounds.size(); ++i) {
      const FlatTree::Source& source = flat.sources[i];
      for (int point = 0; source.node >= 0 && point < 3; ++point) {
        const PrimRef prim =
            flat.order[static_cast<std::size_t>(source.first_prim) + random.below(static_cast<std::size_t>(source.end_prim - source.first_prim))];
        const Exact p = surface_point(scene.pools(), prim, random) + error_for(volume, tight_bounds(scene.pools(), prim), random);
        ASSERT_TRUE(holds(volume, bounds[i], p)) << scene.name << " " << technique << " node " << i;
      }
    }
  }
}

TEST(NodeVolumes, HoldWhatIsBelow) {
  for (const SceneGenerator& generator : scene_generators()) {
    Scene scene = generator.make(std::min(generator.default_size, std::max(generator.min_size, 3)));
    scene.name = std::string(generator.spec_prefix);
    expect_ancestors_hold(AabbVolume{}, scene);
    expect_ancestors_hold(SphereVolume{}, scene);
    expect_ancestors_hold(ObbVolume{}, scene);
    expect_ancestors_hold(KdopVolume(scene, 18), scene);
  }
}

/// Remembers around how many primitives it was fitted at most.
template <class V>
struct Watched : V {
  std::atomic<std::size_t>* most;

  Watched(const V& volume, std::atomic<std::size_t>& most_fitted) : V(volume), most(&most_fitted) {}
  using V::fit;
  [[nodiscard]] auto fit(const Scene& scene, std::span<const PrimRef> prims) const {
    for (std::size_t seen = *most; seen < prims.size() && !most->compare_exchange_weak(seen, prims.size());) {
    }
    return V::fit(scene, prims);
  }
};

template <class V>
void expect_large_nodes_are_merged(const V& volume, const Scene& scene) {
  Random random(34);
  const BvhTree tree = build_bvh_tree(scene, BvhParams(), 2);
  const FlatTree flat = flatten(tree);
  std::atomic<std::size_t> most_fitted = 0;
  const auto bounds = link_bounds(Watched<V>(volume, most_fitted), scene, tree, flat, false, 2);
  EXPECT_GT(most_fitted, 1000u);
  EXPECT_LE(most_fitted, static_cast<std::size_t>(kMostFitted));
  int merged = 0;
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    const FlatTree::Source& source = flat.sources[i];
    if (source.node < 0 || source.end_prim - source.first_prim <= kMostFitted) continue;
    ++merged;
    for (int point = 0; point < 300; ++point) {
      const PrimRef prim =
          flat.order[static_cast<std::size_t>(source.first_prim) + random.below(static_cast<std::size_t>(source.end_prim - source.first_prim))];
      const Exact p = surface_point(scene.pools(), prim, random) + error_for(volume, tight_bounds(scene.pools(), prim), random);
      ASSERT_TRUE(holds(volume, bounds[i], p)) << "node " << i;
    }
  }
  EXPECT_GT(merged, 3);
}

TEST(NodeVolumes, WithTooMuchToCopyAreMergedAndHoldWhatIsBelow) {
  Random random(35);
  Scene scene;
  for (int i = 0; i < 5 * kMostFitted; ++i) {
    const glm::dvec3 p = 100.0 * random.in_cube() * glm::dvec3(1, 1, 0.1);
    if (i % 2 == 0)
      scene.add_sphere(p, random.uniform());
    else
      scene.add_triangle(p, p + random.in_cube(), p + random.in_cube());
  }
  scene.finish();
  expect_large_nodes_are_merged(SphereVolume{}, scene);
  expect_large_nodes_are_merged(ObbVolume{}, scene);
}

}  // namespace
}  // namespace raymeter
