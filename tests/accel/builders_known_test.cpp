// Small inputs whose hierarchies are known, one paper at a time.

#include <algorithm>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "accel/bvh/binned_splits.h"
#include "accel/bvh/binning_kernel.h"
#include "accel/bvh/box_builders.h"
#include "accel/bvh/collapse.h"
#include "accel/bvh/merge_leaves.h"
#include "accel/bvh/morton_order.h"
#include "accel/bvh/reinsertion.h"
#include "accel/kernel_set.h"
#include "core/bounds/split_reference.h"
#include "core/geometry/error_bounds.h"

namespace raymeter {
namespace {

/// Small spheres at places on the x axis.
Scene spheres_at(std::initializer_list<double> places) {
  Scene scene;
  for (const double x : places) scene.add_sphere({x, 0, 0}, 0.25);
  scene.finish();
  return scene;
}

SahParams one_a_leaf() {
  SahParams params;
  params.max_leaf_size = 1;
  return params;
}

/// The primitives below a node.
std::set<std::uint32_t> below(const BvhTree& tree, std::int32_t n) {
  std::set<std::uint32_t> prims;
  const BvhTree::Node& node = tree.node(n);
  for (std::int32_t i = node.first; i < node.first + node.prim_count; ++i) prims.insert(tree.order[static_cast<std::size_t>(i)].index);
  for (std::int32_t c = node.first; c < node.first + node.child_count; ++c) prims.merge(below(tree, c));
  return prims;
}

std::set<std::set<std::uint32_t>> children_of_root(const BvhTree& tree) {
  std::set<std::set<std::uint32_t>> children;
  for (std::int32_t c = tree.nodes[0].first; c < tree.nodes[0].first + tree.nodes[0].child_count; ++c) children.insert(below(tree, c));
  return children;
}

using Groups = std::set<std::set<std::uint32_t>>;

TEST(SweepSah, SplitsWhereTheGapIs) { EXPECT_EQ(children_of_root(build_sweep_sah(spheres_at({9, 0, 8, 1, 2}), one_a_leaf(), 1)), (Groups{{1, 3, 4}, {0, 2}})); }

TEST(SweepSah, MakesALeafWhereNoSplitIsCheaper) {
  // Coincident: two children cost as much as the node, and the node itself besides.
  const BvhTree tree = build_sweep_sah(spheres_at({1, 1, 1, 1, 1}), {}, 1);
  ASSERT_EQ(tree.nodes.size(), 1u);
  EXPECT_EQ(tree.nodes[0].prim_count, 5);
}

TEST(Lbvh, SplitsInTheMiddleOfTheCell) {
  // In the middle between 0 and 16, and not where the gap is.
  EXPECT_EQ(children_of_root(build_lbvh(spheres_at({0, 7, 9, 16}), one_a_leaf(), 1)), (Groups{{0, 1}, {2, 3}}));
  EXPECT_EQ(children_of_root(build_lbvh(spheres_at({0, 1, 2, 16}), one_a_leaf(), 1)), (Groups{{0, 1, 2}, {3}}));
}

TEST(MortonOrder, InterleavesXInTheLowestBits) {
  std::vector<BuildPrim> prims;
  for (const glm::vec3 corner : {glm::vec3(1, 1, 1), {0, 0, 1}, {0, 1, 0}, {1, 0, 0}, {0, 0, 0}, {1, 1, 0}}) prims.push_back({{corner, corner}, {}});
  std::vector<std::int32_t> order;
  for (const MortonPrim& at : build_morton_order(prims)) order.push_back(at.prim);
  EXPECT_EQ(order, (std::vector<std::int32_t>{4, 3, 2, 5, 1, 0}));
  EXPECT_EQ(build_morton_order(prims).back().code, (std::uint64_t{1} << 63) - 1);
}

TEST(Ploc, MergesNearestNeighboursFirst) {
  // LBVH would cut between 7 and 9; the pairs of nearest are 0 1, 7 9, 14 15; then the pair in the middle joins its nearer neighbour.
  EXPECT_EQ(children_of_root(build_ploc(spheres_at({0, 1, 7, 9, 14, 15}), one_a_leaf(), {}, 1)), (Groups{{0, 1}, {2, 3, 4, 5}}));
}

TEST(MergeLeaves, KeepsWhatIsCheaperApart) {
  SahParams params;
  const BvhTree apart = build_lbvh(spheres_at({0, 100}), params, 1);
  EXPECT_EQ(apart.nodes.size(), 3u);
  const BvhTree together = build_lbvh(spheres_at({0, 0.1}), params, 1);
  EXPECT_EQ(together.nodes.size(), 1u);
}

TEST(SplitReference, CutsATriangleAndPadsItsPartsLikeTheWhole) {
  Scene scene;
  scene.add_triangle({0, 0, 0}, {4, 0, 0}, {4, 4, 0});
  scene.add_sphere({0, 0, 0}, 1);
  scene.finish();
  const SplitReference triangle{tight_bounds(scene.pools(), scene.prim(0)), scene.prim(0)};
  const CutReference sides = cut(scene.pools(), triangle, 0, 1);
  EXPECT_EQ(sides.left.min, glm::vec3(0, 0, 0));
  EXPECT_EQ(sides.left.max.x, 1);
  EXPECT_GE(sides.left.max.y, 1);
  EXPECT_NEAR(sides.left.max.y, 1, 2 * 0x1p-23);  // rounded, and a step outwards
  EXPECT_EQ(sides.right.min, glm::vec3(1, 0, 0));
  EXPECT_EQ(sides.right.max, glm::vec3(4, 4, 0));
  const Aabb padded_left = padded_part(scene.pools(), {sides.left, scene.prim(0)});
  EXPECT_GE(padded_left.max.x - 1, kBoundsPadding * 4);
  EXPECT_LE(padded_left.max.x - 1, kBoundsPadding * 4 + 2 * 0x1p-23f);
  // Beyond the triangle there is nothing; of a sphere only its box is cut.
  EXPECT_TRUE(cut(scene.pools(), triangle, 0, 5).right.empty());
  const SplitReference sphere{tight_bounds(scene.pools(), scene.prim(1)), scene.prim(1)};
  EXPECT_EQ(cut(scene.pools(), sphere, 1, 0.5).right.min, glm::vec3(-1, 0.5, -1));
}

TEST(Sbvh, CutsLongDiagonalTriangles) {
  // A sheaf of parallel diagonals: any split by centres leaves two boxes as large as all.
  Scene scene;
  for (int i = 0; i < 128; ++i) scene.add_triangle({0, 0.01 * i, 0}, {10, 10 + 0.01 * i, 0}, {10, 10 + 0.01 * i, 0.01});
  scene.finish();
  const BuildStats whole = tree_stats(build_sweep_sah(scene, {}, 1)), cut = tree_stats(build_sbvh(scene, {}, {}, 1));
  EXPECT_EQ(whole.references, 128);
  EXPECT_GT(cut.references, 128);
  EXPECT_LE(cut.references, 256);  // split_budget = 1
  EXPECT_LT(cut.sah_cost.value(), whole.sah_cost.value());
  SbvhParams none;
  none.split_budget = 0;
  EXPECT_EQ(tree_stats(build_sbvh(scene, {}, none, 1)).references, 128);
}

/// Four leaves in two pairs that each reach across the scene.
BvhTree crossed_pairs(const Scene& scene) {
  BvhTree tree;
  const auto leaf = [&](std::int32_t id) { return BvhTree::Node{padded_bounds(scene.pools(), scene.prim(id)), id, 0, 1}; };
  for (const std::int32_t first : {1, 3, 5}) tree.nodes.push_back({{}, first, 2, 0});
  for (const std::int32_t id : {0, 2, 1, 3}) tree.nodes.push_back(leaf(id));
  for (std::int32_t n = 2; n >= 0; --n) {
    for (std::int32_t c = 0; c < 2; ++c) tree.node(n).box.grow(tree.node(tree.node(n).first + c).box);
  }
  for (std::int32_t id = 0; id < 4; ++id) tree.order.push_back(scene.prim(id));
  return tree;
}

TEST(Reinsertion, UncrossesPairs) {
  const Scene scene = spheres_at({0, 1, 100, 101});
  const BvhTree crossed = crossed_pairs(scene);
  EXPECT_EQ(children_of_root(crossed), (Groups{{0, 2}, {1, 3}}));
  EXPECT_EQ(children_of_root(reinserted(crossed, 3, 1)), (Groups{{0, 1}, {2, 3}}));
  EXPECT_EQ(children_of_root(reinserted(crossed, 0, 1)), (Groups{{0, 2}, {1, 3}}));
}

TEST(WithWidth, OpensTheLargestChildFirst) {
  const BvhTree tree = build_sweep_sah(spheres_at({0, 1, 2, 50, 100}), one_a_leaf(), 1);
  EXPECT_EQ(children_of_root(tree), (Groups{{0, 1, 2}, {3, 4}}));
  EXPECT_EQ(children_of_root(with_width(tree, 3, 1)), (Groups{{0, 1, 2}, {3}, {4}}));
}

TEST(WithWidth, GroupsTheChildrenOfWiderNodes) {
  const Scene scene = spheres_at({0, 10, 1, 11, 20});
  BvhTree flat;
  flat.nodes.push_back({{}, 1, 5, 0});
  for (std::int32_t id = 0; id < 5; ++id) {
    flat.nodes.push_back({padded_bounds(scene.pools(), scene.prim(id)), id, 0, 1});
    flat.nodes[0].box.grow(flat.nodes.back().box);
    flat.order.push_back(scene.prim(id));
  }
  EXPECT_EQ(children_of_root(with_width(flat, 5, 1)), (Groups{{0}, {1}, {2}, {3}, {4}}));
  const BvhTree binary = with_width(flat, 2, 1);
  EXPECT_EQ(binary.nodes.size(), 9u);
  EXPECT_EQ(children_of_root(binary), (Groups{{0, 2}, {1, 3, 4}}));
}

TEST(BinningKernel, MakesTheSameBinsOnEveryInstructionSet) {
  std::mt19937 random(3);
  const auto uniform = [&] { return static_cast<float>(random() >> 8) * 0x1p-24f - 0.5f; };
  for (const std::size_t count : {1, 2, 13, 95, 96, 97, 1000}) {
    std::vector<BinnedBox> boxes;
    for (std::size_t i = 0; i < count; ++i) {
      Aabb box;
      const glm::vec3 place(uniform(), uniform(), random() % 4 == 0 ? -0.0f : 0.0f);
      box.grow(place);
      box.grow(place + 0.1f * glm::vec3(uniform(), uniform(), uniform()));
      boxes.emplace_back(box, prim_ref(PrimKind::triangle, i));
    }
    const BinMapping mapping(bounds_of(boxes).centers2, bin_count(32, count));
    Bins wanted;
    wanted.clear(mapping.bins);
    for (const BinnedBox& one : boxes) {
      for (int a = 0; a < 3; ++a) {
        const int b = std::min(static_cast<int>((one.box.min[a] + one.box.max[a] - mapping.offset[a]) * mapping.scale[a]), mapping.bins - 1);
        grow(wanted.box[a][b], one.box);
        ++wanted.entering[a][b];
      }
    }
    for (const Isa isa : kIsas) {
      if (!available(isa)) continue;
      Bins bins;
      for_isa(isa, []<Isa I>() { return BinningKernel<I>::bin; })(boxes.data(), count, mapping, bins);
      for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < mapping.bins; ++b) {
          EXPECT_EQ(bins.entering[a][b], wanted.entering[a][b]) << name(isa);
          EXPECT_EQ(bins.leaving[a][b], wanted.entering[a][b]) << name(isa);
          for (int row = 0; row < 3; ++row) {
            EXPECT_EQ(float{bins.box[a][b].min[row]}, float{wanted.box[a][b].min[row]}) << name(isa) << ' ' << count;
            EXPECT_EQ(float{bins.box[a][b].max[row]}, float{wanted.box[a][b].max[row]}) << name(isa) << ' ' << count;
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace raymeter
