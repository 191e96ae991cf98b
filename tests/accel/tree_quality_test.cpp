#include <numbers>

#include <gtest/gtest.h>

#include "accel/bvh/bvh.h"
#include "accel/bvh/surface_measure.h"
#include "accel/bvh/tree_quality.h"
#include "core/bounds/aabb_volume.h"
#include "tests/support/random.h"

namespace raymeter {
namespace {

/// Squares of side 1 at (x, y, 0).
Scene squares(std::initializer_list<glm::dvec2> corners) {
  Scene scene;
  for (const glm::dvec2& c : corners) {
    const std::array<glm::dvec3, 4> square{{{c.x, c.y, 0}, {c.x + 1, c.y, 0}, {c.x + 1, c.y + 1, 0}, {c.x, c.y + 1, 0}}};
    scene.add_polygon(square);
  }
  scene.finish();
  return scene;
}

/// A root over one leaf a primitive, in the given boxes.
BvhTree flat_tree(const Scene& scene, const std::vector<Aabb>& boxes) {
  BvhTree tree;
  tree.nodes.push_back({{}, 1, static_cast<std::int32_t>(boxes.size()), 0});
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    tree.nodes[0].box.grow(boxes[i]);
    tree.nodes.push_back({boxes[i], static_cast<std::int32_t>(i), 0, 1});
    tree.order.push_back(scene.prim(static_cast<std::int32_t>(i)));
  }
  return tree;
}

BuildStats quality(const Scene& scene, const BvhTree& tree, int threads = 1) {
  BuildStats stats = tree_stats(tree);
  std::vector<NodeMeasure> measures;
  for (const BvhTree::Node& node : tree.nodes) measures.push_back({AabbVolume().half_area(node.box), AabbVolume().enclosed(node.box)});
  add_volume_quality(tree, measures, stats);
  add_box_quality(scene, tree, threads, stats);
  return stats;
}

TEST(TreeQuality, EndPointOverlapIsTheForeignSurfaceInEachBox) {
  // Leaf 0 reaches over a quarter of square 1, leaf 1 over nothing else: 0.25 of 2.
  const Scene scene = squares({{0, 0}, {2, 0}});
  const BvhTree tree = flat_tree(scene, {{{0, 0, -1}, {2.5, 0.5, 1}}, {{2, 0, -1}, {3, 1, 1}}});
  const BuildStats stats = quality(scene, tree);
  EXPECT_DOUBLE_EQ(stats.epo.value(), 0.125);
  EXPECT_EQ(stats.epo_se.value(), 0);
}

TEST(TreeQuality, EndPointOverlapCountsALeafPerPrimitive) {
  const Scene scene = squares({{0, 0}, {2, 0}, {4, 0}});
  BvhTree tree = flat_tree(scene, {{{0, 0, -1}, {5, 1, 1}}, {{4, 0, -1}, {5, 1, 1}}});
  tree.nodes[1].prim_count = 2;  // holds squares 0 and 1, reaches over 2
  tree.nodes[2].first = 2;
  tree.order = {scene.prim(0), scene.prim(1), scene.prim(2)};
  EXPECT_DOUBLE_EQ(quality(scene, tree).epo.value(), 2.0 / 3);
}

TEST(TreeQuality, PartsOfOnePrimitiveInTwoLeavesAreBothItsOwn) {
  const Scene scene = squares({{0, 0}});
  BvhTree tree = flat_tree(scene, {{{0, 0, -1}, {0.5, 1, 1}}});
  tree.nodes[0].child_count = 2;
  tree.nodes.push_back({{{0.5, 0, -1}, {1, 1, 1}}, 1, 0, 1});
  tree.nodes[0].box.grow(tree.nodes[2].box);
  tree.order.push_back(scene.prim(0));
  EXPECT_EQ(quality(scene, tree).epo.value(), 0);
}

TEST(TreeQuality, CurvedSurfacesAreSampledWithinTheirStandardError) {
  // A box over the upper half of the other sphere: half its area, a quarter of all.
  Scene scene;
  scene.add_sphere({0, 0, 0}, 1);
  scene.add_sphere({4, 0, 0}, 1);
  scene.finish();
  const BvhTree tree = flat_tree(scene, {{{-1, -1, -1}, {5, 1, 1}}, {{3, -1, -1}, {5, 1, 1}}});
  BvhTree half = tree;
  half.nodes[1].box.min.z = 0;
  const BuildStats stats = quality(scene, half);
  EXPECT_GT(stats.epo_se.value(), 0);
  EXPECT_LT(stats.epo_se.value(), 0.01);
  EXPECT_NEAR(stats.epo.value(), 0.25, 4 * stats.epo_se.value());  // four standard errors, of a fixed sample
  EXPECT_EQ(quality(scene, half, 3).epo.value(), stats.epo.value());
}

TEST(TreeQuality, ShapeOfATreeByHand) {
  const Scene scene = squares({{0, 0}, {3, 0}});
  const BvhTree tree = flat_tree(scene, {{{0, 0, 0}, {1, 1, 1}}, {{3, 0, 0}, {4, 1, 1}}});
  const BuildStats stats = quality(scene, tree);
  EXPECT_DOUBLE_EQ(stats.sibling_distance.value(), 1.5 / std::sqrt(16.0 + 1 + 1));
  EXPECT_DOUBLE_EQ(stats.total_volume.value(), 1.5);  // 4 + 1 + 1, relative to 4
  EXPECT_DOUBLE_EQ(stats.node_volume.value(), 0.5);
  // Half areas: the root 9, at depth 0; the leaves 3 each.
  EXPECT_DOUBLE_EQ(stats.cost_depth.value(), 6.0 / 15);
  EXPECT_EQ(stats.cost_depth_p90.value(), 1);
}

TEST(TreeQuality, ANodeCostsHalfATestForEachChild) {
  const Scene scene = squares({{0, 0}, {1, 0}, {2, 0}, {3, 0}});
  const BvhTree wide = flat_tree(scene, {{{0, 0, 0}, {1, 1, 1}}, {{1, 0, 0}, {2, 1, 1}}, {{2, 0, 0}, {3, 1, 1}}, {{3, 0, 0}, {4, 1, 1}}});
  EXPECT_DOUBLE_EQ(quality(scene, wide).sah_cost.value(), 2 + 4 * 3.0 / 9);
  EXPECT_DOUBLE_EQ(tree_stats(wide).sah_cost.value(), 2 + 4 * 3.0 / 9);
  BvhTree binary = wide;  // two pairs
  binary.nodes.clear();
  for (const BvhTree::Node& node : {BvhTree::Node{wide.nodes[0].box, 1, 2, 0}, {{{0, 0, 0}, {2, 1, 1}}, 3, 2, 0}, {{{2, 0, 0}, {4, 1, 1}}, 5, 2, 0}})
    binary.nodes.push_back(node);
  for (std::size_t n = 1; n < wide.nodes.size(); ++n) binary.nodes.push_back(wide.nodes[n]);
  EXPECT_DOUBLE_EQ(quality(scene, binary).sah_cost.value(), 1 + 2 * 5.0 / 9 + 4 * 3.0 / 9);
}

TEST(TreeQuality, IsOfTheVolumesInUse) {
  Scene scene;
  scene.add_sphere({0, 0, 0}, 1);
  scene.add_sphere({2, 0, 0}, 1);
  scene.finish();
  const ParamValues values = resolve_bvh({{"volume", std::string("sphere")}, {"max_leaf_size", std::int64_t{1}}});
  BuildStats stats = build_bvh(scene, values, 1)->stats();
  add_bvh_quality(scene, values, 1, stats);
  ASSERT_EQ(stats.nodes(), 3);
  // A sphere of radius 2 around two of radius 1, but for padding.
  EXPECT_NEAR(stats.sah_cost.value(), 1 + 2 * 0.25, 1e-4);
  EXPECT_NEAR(stats.volume_area.value(), 4 * std::numbers::pi * (4 + 1 + 1), 1e-3);
  EXPECT_NEAR(stats.total_volume.value(), 1 + 2 * 0.125, 1e-4);
  EXPECT_NEAR(stats.node_volume.value(), 1.25 / 3, 1e-4);
  EXPECT_NEAR(stats.cost_depth.value(), 0.5 / 1.5, 1e-4);
}

TEST(TreeQuality, NothingIsMeasuredOfAnEmptyTree) {
  const BuildStats stats = quality(Scene(), BvhTree());
  EXPECT_FALSE(stats.epo.has_value());
  EXPECT_FALSE(stats.sibling_distance.has_value());
}

TEST(SurfaceMeasure, ClipsConcaveOutlines) {
  // A U of area 7: the box takes the tops of both arms.
  const std::vector<glm::dvec3> u{{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {2, 3, 0}, {2, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}};
  EXPECT_DOUBLE_EQ(area_in_box(u, {{-1, -1, -1}, {4, 4, 1}}), 7);
  EXPECT_DOUBLE_EQ(area_in_box(u, {{-1, 2, -1}, {4, 4, 1}}), 2);
  EXPECT_DOUBLE_EQ(area_in_box(u, {{1.25, 2, -1}, {1.75, 4, 1}}), 0);
  EXPECT_DOUBLE_EQ(area_in_box(u, {{0.5, 0.5, -1}, {2.5, 2, 1}}), 2 * 0.5 + 1 * 2 * 0.5);
}

/// Points lie on the surface, and their share in a half follows its area.
TEST(SurfaceMeasure, PointsAreUniformInArea) {
  Scene scene;
  scene.add_sphere({1, 2, 3}, 2);
  scene.add_triangle({0, 0, 0}, {4, 0, 0}, {0, 4, 0});
  scene.add_cone({0, 0, 0}, 3, {0, 0, 4}, 0);
  const std::array<glm::dvec3, 4> quad{{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}}};
  scene.add_polygon(quad);
  scene.finish();
  EXPECT_DOUBLE_EQ(surface_area(scene.pools(), scene.prim(0)), 16 * std::numbers::pi);
  EXPECT_DOUBLE_EQ(surface_area(scene.pools(), scene.prim(1)), 8);
  EXPECT_DOUBLE_EQ(surface_area(scene.pools(), scene.prim(2)), 15 * std::numbers::pi);
  EXPECT_DOUBLE_EQ(surface_area(scene.pools(), scene.prim(3)), 4);
  // The share below a plane, by geometry: x < 1 of the sphere; x < 2 of the triangle, 3/4; the cone below half its height, 3/4.
  const std::array<std::pair<glm::length_t, double>, 3> planes{{{0, 1}, {0, 2}, {2, 2}}};
  const std::array<double, 3> shares{0.5, 0.75, 0.75};
  test::Random random(5);
  constexpr int kPoints = 20000;
  for (std::int32_t id = 0; id < 3; ++id) {
    const auto [axis, position] = planes[static_cast<std::size_t>(id)];
    int below = 0;
    for (int k = 0; k < kPoints; ++k) {
      const double u = random.uniform();
      const glm::dvec3 p = point_on_surface(scene.pools(), scene.prim(id), u, random.uniform());
      below += p[axis] < position;
      const Aabb box = padded_bounds(scene.pools(), scene.prim(id));
      ASSERT_TRUE(glm::all(glm::lessThanEqual(glm::dvec3(box.min), p)) && glm::all(glm::lessThanEqual(p, glm::dvec3(box.max))));
    }
    EXPECT_NEAR(below / double(kPoints), shares[static_cast<std::size_t>(id)], 4 * std::sqrt(0.25 / kPoints)) << id;  // four standard deviations
  }
}

}  // namespace
}  // namespace raymeter
