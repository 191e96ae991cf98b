#include "accel/grid/recursive_grid.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "experiments/scenes/scene_source.h"
#include "tests/support/adversarial.h"
#include "tests/support/answer.h"
#include "tests/support/grid_rays.h"
#include "tests/support/traces.h"

namespace raymeter {
namespace {

using namespace test;

void expect_equals_list(const Scene& scene, const RayBatch& rays, const std::string& technique, std::initializer_list<int> packets = {1, 5, 64}) {
  for (const Isa isa : kIsas) {
    if (!available(isa)) continue;
    const Answer list = answer(scene, rays, "list", isa, simd_width(isa));
    for (const int packet : packets) {
      SCOPED_TRACE(technique + " " + std::string(name(isa)) + " packet " + std::to_string(packet));
      const Answer grid = answer(scene, rays, technique, isa, packet);
      expect_same_hits(grid.hits, list.hits, rays);
      for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_EQ(grid.blocker[i] >= 0, list.hits.prim[i] >= 0) << "ray " << i;
    }
  }
}

BuildStats stats_of(const Scene& scene, const std::string& technique, int threads = 2) {
  const TechniqueSpec spec = parse_technique(technique);
  return spec.structure->build(scene, spec.params, threads)->stats();
}

TEST(RecursiveGrid, EqualsListBitForBit) {
  const Scene scene = mixed_scene(1200, 0.1);
  const RayBatch rays = random_rays(1000);
  for (const char* technique : {"recursive_grid", "recursive_grid:levels=1", "recursive_grid:levels=2,top_density=0.01,density=8",
                                "recursive_grid:levels=4,max_leaf_size=1", "recursive_grid:rule=customary", "recursive_grid:mailbox=off,start=origin"}) {
    expect_equals_list(scene, rays, technique);
  }
}

TEST(RecursiveGrid, EqualsListAtHugeAndTinyCoordinatesAndFarFromTheOrigin) {
  for (const double scale : {1e-8, 1e8}) {
    expect_equals_list(mixed_scene(400, 0.2, scale), random_rays(400, scale), "recursive_grid:max_leaf_size=1", {1, 64});
    expect_equals_list(mixed_scene(400, 0.2, 1, glm::dvec3(scale)), random_rays(400, 1, glm::dvec3(scale)), "recursive_grid:max_leaf_size=1", {1, 64});
  }
  expect_equals_list(mixed_scene(400, 0.2, 1, {1e4, -3e4, 0}), random_rays(400, 1, {1e4, -3e4, 0}), "recursive_grid:max_leaf_size=1", {1, 64});
}

TEST(RecursiveGrid, EqualsListOnPlanesEdgesAndCornersOfBothLevels) {
  std::mt19937 random(4);
  Scene scene;  // unit cubes' corners and faces; the outermost grid has cells of 4, the inner ones of 1
  for (int i = 0; i < 600; ++i) {
    const glm::dvec3 p(static_cast<double>(random() % 8), static_cast<double>(random() % 8), static_cast<double>(random() % 8));
    if (i % 3 == 0)
      scene.add_sphere(p + 0.5, 0.5);
    else
      scene.add_triangle(p, p + glm::dvec3(i % 2, 1, 0), p + glm::dvec3(0, i % 2, 1));
  }
  scene.finish();
  expect_equals_list(scene, lattice_rays(3000, 8), "recursive_grid:top_density=0.014,density=0.9,max_leaf_size=2,levels=4", {1, 16});
}

TEST(RecursiveGrid, EndsForAMillionAdversarialRaysAndAnswersAsTheList) {
  Scene scene;
  for (int i = 0; i < 4; ++i) {
    const double at = 0.25 * i;
    scene.add_triangle({at, 0, 0}, {8, 8 - at, 8}, {0, 8, 8 - at});
    scene.add_sphere({2 * at + 0.5, 2 * at + 0.5, 0.5}, 0.5);
  }
  scene.finish();
  const RayBatch rays = lattice_rays(kAdversarialRays, 8);
  // Every ray at most nx + ny + nz - 2 cells on each level.
  RecursiveGridParams params;
  params.top_density = params.density = 8;
  params.max_leaf_size = 1;
  params.levels = 4;
  const RecursiveGrid grids = build_nested_grids(scene, params, 1);
  std::int32_t inner = 0;
  const auto cells_on_a_way = [](const NestedGrid& cells) { return cells.resolution[0] + cells.resolution[1] + cells.resolution[2] - 2; };
  for (std::size_t g = 1; g < grids.grids.size(); ++g) inner = std::max(inner, cells_on_a_way(grids.grids[g]));
  std::uint64_t bound = static_cast<std::uint64_t>(cells_on_a_way(grids.grids[0]));
  for (int level = 0; level < grids.depth; ++level) bound *= static_cast<std::uint64_t>(inner);
  for (const Isa isa : {Isa::scalar, best_isa()}) {
    const HitBatch list = answer(scene, rays, "list", isa, 64).hits;
    const Steps steps = expect_to_end_as_list(scene, rays, "recursive_grid:top_density=8,density=8,max_leaf_size=1,levels=4", isa, list);
    EXPECT_GT(steps.stats.max_depth, 1);
    EXPECT_LE(steps.leaves, bound) << name(isa);
    EXPECT_GT(steps.leaves, static_cast<std::uint64_t>(cells_on_a_way(grids.grids[0]))) << "no ray went down";
  }
}

TEST(RecursiveGrid, OfOneLevelVisitsTheCellsOfTheUniformGrid) {
  const Scene scene = mixed_scene(2000, 0.1);
  const RayBatch rays = random_rays(2000);
  const Counters uniform = answer(scene, rays, "grid:density=2,mailbox=off", Isa::scalar, 1).closest;
  const Counters nested = answer(scene, rays, "recursive_grid:levels=1,top_density=2,mailbox=off", Isa::scalar, 1).closest;
  EXPECT_EQ(nested.live(Event::leaf_visit), uniform.live(Event::leaf_visit));
  EXPECT_EQ(nested.live(Event::empty_leaf_visit), uniform.live(Event::empty_leaf_visit));
  EXPECT_EQ(nested.live(Event::prim_test), uniform.live(Event::prim_test));
  EXPECT_EQ(nested.live(Event::node_visit), uniform.live(Event::node_visit) + rays.size());
}

TEST(RecursiveGrid, FindsTheTeapotInTheStadium) {
  const Scene scene = load_scene("gen:stadium");
  const BuildStats one = stats_of(scene, "grid"), nested = stats_of(scene, "recursive_grid");
  EXPECT_GT(nested.max_depth, 0);
  EXPECT_LT(nested.references, 16 * one.references);
  RayBatch rays;
  std::mt19937 random(6);
  const auto& columns = scene.pools().triangles.vertex[0];
  for (int i = 0; i < 500; ++i) {
    const std::size_t t = random() % columns[0].size();
    const glm::dvec3 target(columns[0][t], columns[1][t], columns[2][t]);
    rays.push_back(ray(target + (2.0 * point(random) - 1.0), 1.0 - 2.0 * point(random)));
  }
  const Counters uniform = answer(scene, rays, "grid", Isa::scalar, 1).closest, recursive = answer(scene, rays, "recursive_grid", Isa::scalar, 1).closest;
  EXPECT_LT(2 * recursive.live(Event::prim_test), uniform.live(Event::prim_test));
}

TEST(RecursiveGrid, RemembersWhatItTested) {
  const Scene scene = mixed_scene(2000, 0.3);
  const RayBatch rays = random_rays(1000);
  const Counters on = answer(scene, rays, "recursive_grid", Isa::scalar, 1).closest,
                 off = answer(scene, rays, "recursive_grid:mailbox=off", Isa::scalar, 1).closest;
  EXPECT_LT(on.live(Event::prim_test), off.live(Event::prim_test));
  EXPECT_EQ(on.live(Event::node_visit), off.live(Event::node_visit));
}

TEST(RecursiveGrid, IsTheSameOnAnyNumberOfThreads) {
  const Scene scene = load_scene("gen:terrain:20000");
  RecursiveGridParams params;
  const RecursiveGrid one = build_nested_grids(scene, params, 1), three = build_nested_grids(scene, params, 3);
  EXPECT_EQ(one.grids.size(), three.grids.size());
  EXPECT_GT(one.grids.size(), 1u);
  EXPECT_TRUE(std::ranges::equal(one.cells.span(), three.cells.span(), {}, &CellLink::value, &CellLink::value));
  EXPECT_TRUE(std::ranges::equal(one.first.span(), three.first.span()));
  EXPECT_TRUE(std::ranges::equal(one.refs.span(), three.refs.span()));
}

TEST(RecursiveGrid, EndsOnDegenerateScenes) {
  const auto build = [](const Scene& scene) { return stats_of(scene, "recursive_grid:max_leaf_size=1,levels=4,density=64,top_density=64"); };
  Scene empty;
  empty.finish();
  EXPECT_EQ(build(empty).references, 0);
  Scene same;
  for (int i = 0; i < 100000; ++i) same.add_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 1});
  same.finish();
  EXPECT_LE(build(same).references, 33 * 100000 + (1 << 20));
  Scene flat;
  for (int i = 0; i < 100; ++i) flat.add_triangle({i, 0, 0}, {i + 1, 0, 0}, {i, 1, 0});
  flat.finish();
  EXPECT_GT(build(flat).leaves, 0);
  Scene mixed;
  mixed.add_sphere({0, 0, 0}, 1e6);
  for (int i = 0; i < 1000; ++i) mixed.add_sphere({1e6 + 1e-3 * i, 0, 0}, 1e-3);
  mixed.finish();
  EXPECT_LT(build(mixed).references, 1024 * 1001 + (1 << 20));
}

}  // namespace
}  // namespace raymeter
