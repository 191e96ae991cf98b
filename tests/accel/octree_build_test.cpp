#include <gtest/gtest.h>

#include <cstring>
#include <numeric>
#include <utility>

#include "accel/octree/cell_overlap.h"
#include "accel/octree/cell_split.h"
#include "accel/octree/octree_tree.h"
#include "tests/support/grid_rays.h"
#include "tests/support/test_rays.h"

namespace raymeter {
namespace {

using namespace test;

template <class T>
bool same(const Column<T>& a, const Column<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

TEST(OctreeBuild, IsTheSameOnAnyNumberOfThreads) {
  const Scene scene = mixed_scene(20000, 0.02);
  for (const char* rule : {"center", "cost", "ends", "boxes", "centers", "mean", "mean_of_all", "length"}) {
    OctreeParams params;
    params.split = std::string_view(rule) == "center" ? "center" : "cost";
    if (std::string_view(rule) == "ends") params.cost_planes = rule;
    if (std::string_view(rule) == "boxes") params.cost_median = rule;
    if (std::string_view(rule).starts_with("mean")) params.cost_middle = rule;
    if (std::string_view(rule) == "length") params.cost_measure = rule;
    if (std::string_view(rule) == "centers") params.cost_counts = rule;
    const Octree one = build_octree_tree(scene, params, 1);
    for (const int threads : {2, 7}) {
      const Octree many = build_octree_tree(scene, params, threads);
      EXPECT_TRUE(same(one.nodes, many.nodes) && same(one.first, many.first) && same(one.refs, many.refs) && same(one.outline, many.outline));
    }
  }
}

/// The leaf in which a point lies.
std::size_t leaf_at(const Octree& tree, const glm::dvec3& p) {
  std::int32_t link = tree.root;
  while (link >= 0) {
    const OctreeNode& node = tree.nodes[static_cast<std::size_t>(link)];
    int child = 0;
    for (glm::length_t a = 0; a < 3; ++a) child |= p[a] >= double{node.split[a]} ? 1 << a : 0;
    link = node.child[child];
  }
  return static_cast<std::size_t>(~link);
}

bool lists(const Octree& tree, std::size_t leaf, std::int32_t prim) {
  for (std::size_t k = 0; k < tree.kinds.size(); ++k) {
    const std::size_t slot = leaf * tree.kinds.size() + k;
    for (auto r = static_cast<std::size_t>(tree.first[slot]); r < static_cast<std::size_t>(tree.first[slot + 1]); ++r) {
      if (tree.pools.prim_id(prim_ref(tree.kinds[k], static_cast<std::size_t>(tree.refs[r]))) == prim) return true;
    }
  }
  return false;
}

TEST(OctreeBuild, ListsAPrimitiveWhereverItHasAPoint) {
  const Scene scene = mixed_scene(400, 0.3);
  Random random(5);
  for (const char* placement : {"exact", "box"}) {
    OctreeParams params;
    params.placement = placement;
    params.leaf_size = 1;
    params.max_depth = 6;
    const Octree tree = build_octree_tree(scene, params, 2);
    ASSERT_GT(tree.nodes.size(), 500u);
    for (std::size_t k = 0; k < kPrimKindCount; ++k) {
      for (std::size_t i = 0; i < scene.pools().size(static_cast<PrimKind>(k)); ++i) {
        const PrimRef ref = prim_ref(static_cast<PrimKind>(k), i);
        for (int n = 0; n < 50; ++n) {
          glm::dvec3 p = point_of(scene, ref, random);
          if (ref.kind() == PrimKind::sphere) {  // not inside
            for (std::size_t a = 0; a < 3; ++a) p[static_cast<glm::length_t>(a)] = double{scene.pools().spheres.center[a][i]};
            p += double{scene.pools().spheres.radius[i]} * random.direction();
          }
          ASSERT_TRUE(lists(tree, leaf_at(tree, p), scene.pools().prim_id(ref))) << placement << " kind " << k << " " << i;
        }
      }
    }
  }
}

TEST(OctreeBuild, ExactPlacementListsLessAndTheBoxListsAllOfIt) {
  const Scene scene = mixed_scene(2000, 0.2);
  OctreeParams exact, box;
  box.placement = "box";
  exact.max_depth = box.max_depth = 5;
  exact.budget = box.budget = 4096;
  EXPECT_LT(build_octree_tree(scene, exact, 2).stats.references, build_octree_tree(scene, box, 2).stats.references * 3 / 4);
}

TEST(OctreeBuild, DividesCellsOfMoreThanLeafSizeDownToTheDepth) {
  const Scene scene = mixed_scene(500, 0.05);
  OctreeParams params;
  params.leaf_size = 3;
  params.max_depth = 5;
  params.budget = 4096;
  const Octree tree = build_octree_tree(scene, params, 2);
  EXPECT_EQ(tree.stats.leaves, 7 * tree.stats.interior_nodes + 1);
  EXPECT_EQ(*tree.stats.max_depth, 5);
  params.max_depth = 12;
  const Octree deep = build_octree_tree(scene, params, 2);
  EXPECT_GT(deep.stats.interior_nodes, tree.stats.interior_nodes);
  EXPECT_LE(deep.stats.references, 4096 * 1024);
}

TEST(OctreeBuild, DividesCellsAsSmallAsAskedForWhereAllDetailIsInOneSpot) {
  Scene scene;
  scene.add_triangle({-200, -200, 0}, {200, -200, 0}, {0, 200, 0});
  for (int i = 0; i < 1000; ++i) scene.add_sphere({i % 10 * 0.02, i / 10 % 10 * 0.02, 0.1 + i / 100 * 0.02}, 0.004);
  scene.finish();
  OctreeParams params;
  params.max_depth = 20;
  const Octree coarse = build_octree_tree(scene, params, 2);
  params.least_cell = 2;
  const Octree fine = build_octree_tree(scene, params, 2);
  // Three more halvings, from 16 to 2 reaches of lists.
  EXPECT_EQ(*fine.stats.max_depth, *coarse.stats.max_depth + 3);
  const auto longest = [](const Octree& tree) {
    std::int32_t most = 0;
    for (std::size_t i = 1; i < tree.first.size(); ++i) most = std::max(most, tree.first[i] - tree.first[i - 1]);
    return most;
  };
  EXPECT_LT(longest(fine), longest(coarse) / 4);
}

TEST(OctreeBuild, KeepsToItsBudgetWhereEverythingCoincides) {
  Scene scene;
  for (int i = 0; i < 100000; ++i) scene.add_triangle({0, 0, 0}, {1, 0, 1}, {0, 1, 1});
  scene.finish();
  OctreeParams params;
  params.max_depth = 20;
  params.leaf_size = 1;
  params.budget = 4;
  const Octree tree = build_octree_tree(scene, params, 2);
  EXPECT_LE(tree.stats.references, 4 * 100000);
}

/// Where the plane of least cost across x divides the cell from 0 to 16.
float plane_of_least_cost(const OctreeParams& params, const std::vector<Aabb>& boxes, double margin = 0) {
  std::vector<std::uint32_t> all(boxes.size());
  std::iota(all.begin(), all.end(), 0u);
  return split_point(SplitRule(params), {{glm::vec3(0.0F), glm::vec3(16.0F)}, 0, margin}, boxes, all).x;
}

/// A box from x = low to high, across the cell.
Aabb slice(float low, float high) { return {{low, 0, 0}, {high, 16, 16}}; }

TEST(CellSplit, TakesWhatIsAskedForAsTheObjectsMedian) {
  OctreeParams params;
  params.split = "cost";
  params.cost_count = 1;                                                               // halfway from the cell's middle to the median
  const std::vector<Aabb> boxes{slice(1, 1), slice(2, 2), slice(4, 4), slice(5, 15)};  // around 1, 2, 4, 10
  for (const auto& [median, plane] : {std::pair{"upper", 6.0F}, {"mean", 5.5F}, {"mean_of_all", 6.125F}}) {
    params.cost_middle = median;
    EXPECT_EQ(plane_of_least_cost(params, boxes), plane) << median;
  }
}

TEST(CellSplit, TriesTheEndsThatAreAskedFor) {
  OctreeParams params;
  params.split = "cost";
  params.cost_count = 2;
  // All objects lie in the same plane, the median: the nearer a plane, the cheaper, but in it they are on both sides.
  const std::vector<Aabb> boxes{slice(2, 2), slice(2, 2)};
  for (const auto& [planes, plane] : {std::pair{"between", 4.0F}, {"ends", 8.0F}}) {
    params.cost_planes = planes;
    EXPECT_EQ(plane_of_least_cost(params, boxes), plane) << planes;
  }
}

TEST(CellSplit, CountsOnEachSideWhatItsListWillHold) {
  OctreeParams params;
  params.split = "cost";
  params.cost_count = 3;  // planes at 6.5, 5 and 3.5
  const std::vector<Aabb> boxes{slice(1.5F, 3), slice(2, 2), slice(2, 2)};
  EXPECT_EQ(plane_of_least_cost(params, boxes), 3.5F);
  EXPECT_EQ(plane_of_least_cost(params, boxes, 0.75), 5.0F) << "the list above 3.5 holds what ends at 3";
}

TEST(CellOverlap, SeparatesWhatOnlyHasABoxThere) {
  Scene scene;
  scene.add_triangle({0, 0, 0}, {8, 0, 0}, {0, 8, 0});
  scene.add_sphere({4, 4, 4}, 4);
  const std::array<glm::dvec3, 4> slope{glm::dvec3(0, 0, 0), {8, 0, 8}, {8, 8, 8}, {0, 8, 0}};
  scene.add_polygon(slope);
  scene.add_cone({4, 4, 0}, 2, {4, 4, 8}, 4);
  scene.finish();
  const auto touches = [&](PrimKind kind, const glm::dvec3& center, double half) {
    return may_touch(scene.pools(), prim_ref(kind, 0), center, glm::dvec3(half));
  };
  EXPECT_TRUE(touches(PrimKind::triangle, {3, 3, 0}, 0.5));
  EXPECT_TRUE(touches(PrimKind::triangle, {4.5, 4.5, 0}, 0.5));
  EXPECT_FALSE(touches(PrimKind::triangle, {4.6, 4.5, 0}, 0.5));
  EXPECT_FALSE(touches(PrimKind::triangle, {3, 3, 0.6}, 0.5));
  EXPECT_TRUE(touches(PrimKind::sphere, {0.5, 4, 4}, 0.5));
  EXPECT_FALSE(touches(PrimKind::sphere, {0.5, 0.5, 0.5}, 0.5)) << "a corner of its box";
  EXPECT_FALSE(touches(PrimKind::sphere, {4, 4, 4}, 2)) << "inside";
  EXPECT_TRUE(touches(PrimKind::polygon, {3, 3, 3}, 0.5));
  EXPECT_FALSE(touches(PrimKind::polygon, {3, 3, 5}, 0.5));
  EXPECT_TRUE(touches(PrimKind::cone, {1, 4, 4}, 0.5));
  EXPECT_FALSE(touches(PrimKind::cone, {1, 4, 1}, 0.5)) << "beside the narrow end";
  EXPECT_FALSE(touches(PrimKind::cone, {4, 4, 4}, 1)) << "inside";
}

}  // namespace
}  // namespace raymeter
