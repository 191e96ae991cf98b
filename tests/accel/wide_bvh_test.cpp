#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <set>

#include "accel/bvh/box_builders.h"
#include "accel/bvh/collapse.h"
#include "accel/bvh/wide_tree.h"
#include "accel/registry.h"
#include "core/trace/trace.h"
#include "tests/support/answer.h"
#include "tests/support/test_rays.h"
#include "tests/support/test_scenes.h"

namespace raymeter {
namespace {

using test::Answer;
using test::answer;

/// Vertex (i, j) of a hilly square of n x n quads.
glm::dvec3 vertex(int i, int j, int n, double size, const glm::dvec3& corner) { return corner + size / n * glm::dvec3(i, (i * 7 + j * 3) % 5, j); }

Scene hills(int n, double size, const glm::dvec3& corner) {
  Scene scene;
  const auto at = [&](int i, int j) { return vertex(i, j, n, size, corner); };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      scene.add_triangle(at(i, j), at(i + 1, j), at(i, j + 1));
      scene.add_triangle(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  scene.finish();
  return scene;
}

/// Rays in tiles of 64 that have a slim beam, each at a vertex, at points of its two edges and between: from an eye, from the surface to a light (they
/// converge), parallel ones, and ones along an axis, where two components of the direction are zero of either sign.
RayBatch beams(int n, double size, const glm::dvec3& corner) {
  RayBatch rays;
  const glm::dvec3 eye = corner + size * glm::dvec3(0.4, 1.5, -0.7), light = corner + size * glm::dvec3(0.3, 2, 0.6);
  for (int tile = 0; tile < 24; ++tile) {
    const int i = tile * 5 % n, j = tile * 3 % n;
    const glm::dvec3 v = vertex(i, j, n, size, corner);
    const glm::dvec3 e = (vertex(i + 1, j, n, size, corner) - v) / 16.0, f = (vertex(i, j + 1, n, size, corner) - v) / 16.0;
    for (int r = 0; r < 64; ++r) {
      const glm::dvec3 aim = v + double(r % 8) * e + double(r / 8) * f;
      switch (tile % 4) {
        case 0: rays.push_back(test::make_ray(eye, aim - eye)); break;
        case 1: rays.push_back(test::make_ray(aim, light - aim)); break;
        case 2: rays.push_back(test::make_ray(aim + glm::dvec3(0, size, 0), {r % 2 == 0 ? 0.0 : -0.0, -1, r % 3 == 0 ? 0.0 : -0.0})); break;
        default: rays.push_back(test::make_ray(aim + size * glm::dvec3(-0.5, 0.8, 0.1), {0.5, -0.8, -0.1})); break;
      }
    }
  }
  return rays;
}

TEST(WideTraversal, LosesNoHitAtVerticesNearFarSmallAndLarge) {
  constexpr int n = 40;
  const struct {
    double size;
    glm::dvec3 corner;
  } places[] = {{1, {0, 0, 0}}, {1, {-0.5, -0.5, -0.5}}, {100, {1e6, -1e6, 1e6}}, {1e-8, {0, 0, 0}}, {1e8, {0, 0, 0}}};
  for (const auto& place : places) {
    const double size = place.size;  // clang 14 captures no structured bindings
    const Scene scene = hills(n, size, place.corner);
    const RayBatch rays = beams(n, size, place.corner);
    for (const Isa isa : kIsas) {
      if (!available(isa)) continue;
      const Answer list = answer(scene, rays, "list", isa, simd_width(isa));
      EXPECT_GT(std::ranges::count_if(list.hits.prim.span(), [](std::int32_t prim) { return prim >= 0; }), 1000);
      const auto expect_same = [&](const char* technique, int packet) {
        const Answer bvh = answer(scene, rays, technique, isa, packet);
        EXPECT_TRUE(bits_equal(list.hits, bvh.hits)) << technique << ' ' << name(isa) << " packet " << packet << " size " << size;
        for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_EQ(bvh.blocker[i] >= 0, list.hits.prim[i] >= 0) << i;
      };
      for (const int packet : {4, 24}) expect_same("bvh:traversal=beam", packet);
      for (const char* group : {"16", "48", "64", "256"}) expect_same((std::string("bvh:traversal=beam,group=") + group).c_str(), 64);
      expect_same("bvh:traversal=stream", 64);
      expect_same("bvh:traversal=single", 64);
    }
  }
}

TEST(BeamTraversal, SharesWorkAmongCoherentRays) {
  const Scene scene = hills(40, 1, {0, 0, 0});
  const RayBatch rays = beams(40, 1, {0, 0, 0});
  const Isa isa = Isa::scalar;  // registers of one ray: what is shared is shared by the beam
  const Counters one = answer(scene, rays, "bvh:traversal=beam", isa, 1).closest, sixteen = answer(scene, rays, "bvh:traversal=beam", isa, 16).closest;
  EXPECT_LT(3 * sixteen.executed(Event::volume_test), one.executed(Event::volume_test));
}

class WideTreeOfLeaves : public testing::TestWithParam<LeafUse> {};
INSTANTIATE_TEST_SUITE_P(Builder, WideTreeOfLeaves, testing::Values(LeafUse::as_they_are, LeafUse::for_blocks),
                         [](const auto& tested) { return tested.param == LeafUse::for_blocks ? "ForBlocks" : "AsTheyAre"; });

TEST_P(WideTreeOfLeaves, HoldsEachPrimitiveOnceInsideItsBoxes) {
  for (const Scene& scene : test::hard_scenes()) {
    const WideTree tree = collapse_wide(scene, build_binned_sah(scene, {}, 2, GetParam()), {}, 2);
    std::multiset<std::int32_t> held;
    const Pools pools = reordered(scene.pools(), tree.order);
    for (const WideNode& node : tree.nodes) {
      for (int place = 0; place < kWideChildren; ++place) {
        const auto inside = [&](const Aabb& inner) {
          for (int a = 0; a < 3; ++a) {
            if (inner.min[a] < node.plane[a][place] || inner.max[a] > node.plane[a + 3][place]) return false;
          }
          return true;
        };
        if (!(node.plane[0][place] <= node.plane[3][place])) continue;
        const WideRef child = node.child[place];
        if (child.tag() == WideRef::Tag::inner) {
          const WideNode& below = tree.nodes[child.index()];
          for (int c = 0; c < kWideChildren; ++c) {
            if (!(below.plane[0][c] <= below.plane[3][c])) continue;
            EXPECT_TRUE(inside({{below.plane[0][c], below.plane[1][c], below.plane[2][c]}, {below.plane[3][c], below.plane[4][c], below.plane[5][c]}}));
          }
        } else if (child.tag() == WideRef::Tag::block) {
          const TriangleBlock& block = tree.blocks[child.index()];
          for (std::int32_t t = 0; t < block.count; ++t) {
            held.insert(block.prim[t]);
            EXPECT_TRUE(inside(padded_bounds(scene.pools(), scene.prim(block.prim[t])))) << scene.name;
          }
        } else {
          const PrimitiveRun run = tree.runs[child.index()];
          const Column<std::int32_t>& prim = run.kind() == PrimKind::sphere    ? pools.spheres.prim
                                             : run.kind() == PrimKind::polygon ? pools.polygons.prim
                                                                               : pools.cones.prim;
          for (std::int32_t i = run.first; i < run.first + run.count(); ++i) {
            const std::int32_t id = prim[static_cast<std::size_t>(i)];
            held.insert(id);
            EXPECT_TRUE(inside(padded_bounds(scene.pools(), scene.prim(id)))) << scene.name;
          }
        }
      }
    }
    std::multiset<std::int32_t> wanted;
    for (std::int32_t id = 0; id < scene.prim_id_count(); ++id) {
      if (!scene.prim(id).dropped()) wanted.insert(id);
    }
    EXPECT_EQ(held, wanted) << scene.name;
    EXPECT_EQ(tree.stats.references, static_cast<std::int64_t>(wanted.size())) << scene.name;
  }
}

TEST(WideTree, TakesTreesOfAnyArity) {
  const Scene scene = test::icosphere(2);
  BvhTree tree;  // a root above one node above all primitives, one leaf each
  const std::int32_t prims = scene.prim_id_count();
  tree.nodes.resize(static_cast<std::size_t>(prims) + 2);
  for (std::int32_t id = 0; id < prims; ++id) {
    tree.order.push_back(scene.prim(id));
    BvhTree::Node& leaf = tree.nodes[static_cast<std::size_t>(id) + 2];
    leaf.box = padded_bounds(scene.pools(), scene.prim(id));
    leaf.first = id;
    leaf.prim_count = 1;
    tree.nodes[1].box.grow(leaf.box);
  }
  tree.nodes[1].first = 2;
  tree.nodes[1].child_count = prims;
  tree.nodes[0].box = tree.nodes[1].box;
  tree.nodes[0].first = 1;
  tree.nodes[0].child_count = 1;
  EXPECT_EQ(collapse_wide(scene, with_width(tree, 2, 1), {}, 2).stats.references, prims);
}

TEST(WideTree, OrdersPlacesForEveryOctant) {
  const Scene scene = hills(30, 1, {0, 0, 0});
  const WideTree tree = collapse_wide(scene, build_binned_sah(scene, {}, 2), {}, 2);
  ASSERT_GT(tree.nodes.size(), 10u);
  for (const WideNode& node : tree.nodes) {
    for (const std::uint32_t order : node.order) {
      std::uint32_t seen = 0;
      for (int i = 0; i < kWideChildren; ++i) seen |= 1u << (order >> 4 * i & 15);
      EXPECT_EQ(seen, 0xFFu);
    }
  }
  // Opposite octants see the children in opposite order, those of the root at least: it has eight.
  const WideNode& root = tree.nodes[0];
  for (int i = 0; i < kWideChildren; ++i) EXPECT_EQ(root.order[0] >> 4 * i & 15, root.order[7] >> 4 * (kWideChildren - 1 - i) & 15);
}

TEST_P(WideTreeOfLeaves, HasTheSameBytesOnAnyNumberOfThreads) {
  const auto same_bytes = [](const auto& a, const auto& b) { return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0; };
  std::vector<Scene> scenes = test::hard_scenes();
  scenes.push_back(hills(100, 1, {0, 0, 0}));  // large enough to have a top
  for (const Scene& scene : scenes) {
    const WideTree one = collapse_wide(scene, build_binned_sah(scene, {}, 1, GetParam()), {}, 1);
    for (const int threads : {2, 7}) {
      const WideTree many = collapse_wide(scene, build_binned_sah(scene, {}, threads, GetParam()), {}, threads);
      EXPECT_TRUE(same_bytes(many.nodes, one.nodes) && same_bytes(many.blocks, one.blocks) && same_bytes(many.runs, one.runs)) << scene.name;
      EXPECT_TRUE(std::ranges::equal(many.order, one.order)) << scene.name;
      EXPECT_EQ(many.stats.sah_cost, one.stats.sah_cost);
      EXPECT_EQ(many.stats.max_depth, one.stats.max_depth);
      EXPECT_EQ(many.stack_capacity, one.stack_capacity);
    }
  }
}

TEST_P(WideTreeOfLeaves, FillsItsBlocks) {
  const Scene scene = hills(100, 1, {0, 0, 0});
  const WideTree tree = collapse_wide(scene, build_binned_sah(scene, {}, 2, GetParam()), {}, 2);
  std::int64_t triangles = 0;
  for (const TriangleBlock& block : tree.blocks) triangles += block.count;
  EXPECT_EQ(triangles, 20000);
  // A quad of two triangles takes four vertices, six quads in a row or block twelve to fourteen: sharing is what lets eight and more triangles in.
  EXPECT_GT(triangles, 7 * static_cast<std::int64_t>(tree.blocks.size()));
}

/// What is left undivided costs the wide tree next to nothing: rays would meet as much as in one made of all leaves.
TEST(WideTree, LosesLittleByLeavesForBlocks) {
  for (const Scene& scene : {hills(100, 1, {0, 0, 0}), test::icosphere(5)}) {
    const WideTree all = collapse_wide(scene, build_binned_sah(scene, {}, 2), {}, 2);
    const BvhTree binary = build_binned_sah(scene, {}, 2, LeafUse::for_blocks);
    EXPECT_LT(2 * binary.nodes.size(), build_binned_sah(scene, {}, 2).nodes.size());
    EXPECT_LT(*collapse_wide(scene, binary, {}, 2).stats.sah_cost, 1.01 * *all.stats.sah_cost);
  }
}

}  // namespace
}  // namespace raymeter
