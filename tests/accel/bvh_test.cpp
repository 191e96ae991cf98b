#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "accel/bvh/box_builders.h"
#include "accel/registry.h"
#include "core/trace/trace.h"
#include "tests/support/answer.h"

namespace raymeter {
namespace {

using test::Answer;
using test::answer;

/// Uniform in [0, 1), the same on every library.
double uniform(std::mt19937& random) { return static_cast<double>(random()) * 0x1p-32; }

glm::dvec3 point(std::mt19937& random) { return {uniform(random), uniform(random), uniform(random)}; }

Scene random_scene(int count, double size) {
  std::mt19937 random(1);
  Scene scene;
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 p = point(random);
    switch (i % 4) {
      case 0: scene.add_triangle(p, p + size * point(random), p + size * point(random)); break;
      case 1: scene.add_sphere(p, size * uniform(random)); break;
      case 2: scene.add_cone(p, 0.1 * size, p + size * point(random), 0.05 * size); break;
      default: {
        const glm::dvec3 e = size * point(random), f = size * point(random);
        const std::array<glm::dvec3, 4> quad{p, p + e, p + e + f, p + f};
        scene.add_polygon(quad);
      }
    }
  }
  scene.finish();
  return scene;
}

RayBatch random_rays(int count) {
  std::mt19937 random(2);
  RayBatch rays;
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 from = 3.0 * point(random) - 1.0, to = point(random);
    const glm::vec3 d(to - from);
    rays.push_back({{float(from.x), float(from.y), float(from.z)}, 0, {d.x, d.y, d.z}, std::numeric_limits<float>::infinity()});
  }
  return rays;
}

TEST(Bvh, EqualsListBitForBit) {
  const Scene scene = random_scene(2000, 0.1);
  const RayBatch rays = random_rays(3000);
  for (const Isa isa : kIsas) {
    if (!available(isa)) continue;
    const Answer list = answer(scene, rays, "list", isa, simd_width(isa));
    for (const char* technique : {"bvh", "bvh:traversal=packet", "bvh:traversal=beam", "bvh:traversal=stream", "bvh:traversal=single"}) {
      for (const int packet : {1, 5, 16, 64}) {
        const Answer bvh = answer(scene, rays, technique, isa, packet);
        EXPECT_TRUE(bits_equal(list.hits, bvh.hits)) << technique << " " << name(isa) << " packet " << packet;
        for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_EQ(bvh.blocker[i] >= 0, list.hits.prim[i] >= 0);
      }
    }
  }
}

TEST(BinnedSah, HoldsEachPrimitiveOnceInsideItsBoxes) {
  const Scene scene = random_scene(5000, 0.05);
  const BvhTree tree = build_binned_sah(scene, {}, 2);
  std::vector<int> seen(static_cast<std::size_t>(scene.prim_id_count()), 0);
  const auto inside = [](const Aabb& inner, const Aabb& outer) {
    return glm::all(glm::greaterThanEqual(inner.min, outer.min)) && glm::all(glm::lessThanEqual(inner.max, outer.max));
  };
  std::size_t holding = 0;
  for (const BvhTree::Node& node : tree.nodes) {
    for (std::int32_t c = node.first; c < node.first + node.child_count; ++c) EXPECT_TRUE(inside(tree.nodes[static_cast<std::size_t>(c)].box, node.box));
    for (std::int32_t i = node.first; i < node.first + node.prim_count; ++i) {
      const PrimRef ref = tree.order[static_cast<std::size_t>(i)];
      EXPECT_TRUE(inside(padded_bounds(scene.pools(), ref), node.box));
      ++holding;
    }
  }
  EXPECT_EQ(holding, seen.size());
  for (const PrimRef ref : tree.order) {
    for (std::int32_t id = 0; id < scene.prim_id_count(); ++id) {
      if (scene.prim(id) == ref) {
        ++seen[static_cast<std::size_t>(id)];
        break;
      }
    }
  }
  EXPECT_TRUE(std::all_of(seen.begin(), seen.end(), [](int n) { return n == 1; }));
}

TEST(BinnedSah, DoesNotDependOnThreads) {
  const Scene scene = random_scene(60000, 0.01);
  const BvhTree one = build_binned_sah(scene, {}, 1), seven = build_binned_sah(scene, {}, 7);
  EXPECT_TRUE(one.order == seven.order);
  const BuildStats a = tree_stats(one), b = tree_stats(seven);
  EXPECT_EQ(a.leaves, b.leaves);
  EXPECT_EQ(a.max_depth, b.max_depth);
  EXPECT_EQ(a.sah_cost, b.sah_cost);
}

TEST(BinnedSah, EndsOnDegenerateInput) {
  for (const int count : {0, 1, 2, 100000}) {
    Scene same;
    for (int i = 0; i < count; ++i) same.add_sphere({1, 2, 3}, 1);
    const BvhTree tree = build_binned_sah(same, {}, 2);
    EXPECT_EQ(tree.order.size(), static_cast<std::size_t>(count));
    EXPECT_LE(tree_stats(tree).max_depth.value(), 20);
  }
  Scene growing;  // each sphere five times as far as the one before
  for (int i = 0; i < 76; ++i) growing.add_sphere({std::pow(5.0, i - 50), 0, 0}, 0);
  EXPECT_EQ(build_binned_sah(growing, {}, 1).order.size(), 76u);
}

}  // namespace
}  // namespace raymeter
