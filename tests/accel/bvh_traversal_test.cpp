// The traversals of hierarchies on trees that no builder makes, with every kind of volume.

#include <set>

#include <gtest/gtest.h>

#include "accel/bvh/bvh_structure.h"
#include "accel/volumes.h"
#include "core/trace/trace.h"
#include "tests/support/adversarial.h"
#include "tests/support/answer.h"
#include "tests/support/grid_rays.h"
#include "tests/support/traces.h"

namespace raymeter {
namespace {

/// A leaf for each primitive of the scene, in order, from node `first` on.
BvhTree leaves_of(const Scene& scene, std::size_t first) {
  BvhTree tree;
  tree.nodes.resize(first);
  for (std::int32_t id = 0; id < scene.prim_id_count(); ++id) {
    tree.nodes.push_back({padded_bounds(scene.pools(), scene.prim(id)), id, 0, 1});
    tree.order.push_back(scene.prim(id));
  }
  return tree;
}

Aabb box_of(const Scene& scene) {
  Aabb box;
  for (std::int32_t id = 0; id < scene.prim_id_count(); ++id) box.grow(padded_bounds(scene.pools(), scene.prim(id)));
  return box;
}

/// A root with all primitives as children.
BvhTree flat_tree(const Scene& scene) {
  BvhTree tree = leaves_of(scene, 1);
  tree.nodes[0] = {box_of(scene), 1, scene.prim_id_count(), 0};
  return tree;
}

/// Each inner node has a leaf and the next inner node for children: as deep as it has primitives.
BvhTree chain(const Scene& scene) {
  const Aabb box = box_of(scene);
  BvhTree tree;
  tree.nodes.push_back({box, 1, 2, 0});
  for (std::int32_t id = 0; id < scene.prim_id_count(); ++id) {
    tree.order.push_back(scene.prim(id));
    tree.nodes.push_back({padded_bounds(scene.pools(), scene.prim(id)), id, 0, 1});
    const auto next = static_cast<std::int32_t>(tree.nodes.size()) + 1;
    if (id + 2 < scene.prim_id_count()) tree.nodes.push_back({box, next, 2, 0});
  }
  return tree;
}

void expect_equal_to_list(const Scene& scene, const BvhTree& tree, const RayBatch& rays) {
  for (const Isa isa : {Isa::scalar, best_isa()}) {
    const test::Answer list = test::answer(scene, rays, "list", isa, simd_width(isa));
    for (const char* volume_name : {"aabb", "sphere", "obb", "kdop"}) {
      with_volume(volume_name, VolumeParams{}, scene, [&]<class V>(const V& volume) {
        const BvhStructure<V> structure(scene, tree, volume, 2);
        for (const char* traversal : {"bvh:traversal=packet", "bvh:traversal=heap"}) {
          for (const int packet : {1, kMaxPacket}) {
            const auto intersector = structure.intersector({isa, packet, parse_technique(traversal).params});
            HitBatch hits;
            Column<std::int32_t> blockers;
            trace_closest(*intersector, rays, hits, 2);
            trace_any(*intersector, rays, blockers, 2);
            EXPECT_TRUE(bits_equal(hits, list.hits)) << name(isa) << " " << volume_name << " " << traversal << " packet " << packet;
            for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_EQ(blockers[i] >= 0, list.hits.prim[i] >= 0);
          }
        }
      });
    }
  }
}

TEST(BvhTraversals, GoThroughANodeOf100000Children) {
  const Scene scene = test::mixed_scene(100000, 0.01);
  expect_equal_to_list(scene, flat_tree(scene), test::random_rays(40));
}

TEST(BvhTraversals, GoDownATreeAsDeepAsItHasPrimitives) {
  const Scene scene = test::mixed_scene(1500, 0.1);
  expect_equal_to_list(scene, chain(scene), test::random_rays(130));
}

class BvhSteps : public testing::TestWithParam<Isa> {};

/// All of them in one test, since the list's answers take as long as theirs.
TEST_P(BvhSteps, AMillionAdversarialRaysVisitNoMoreNodesThanThereAreAndAgreeWithTheList) {
  const Isa isa = GetParam();
  const Scene scene = test::lattice_scene(8, 48);
  RayBatch rays = test::lattice_rays(test::kAdversarialRays / 2, 8);
  rays.append(test::box_rays(test::kAdversarialRays / 2, scene));
  const HitBatch list = test::answer(scene, rays, "list", isa, 64).hits;
  for (const char* technique : {"bvh", "bvh:traversal=packet", "bvh:traversal=heap", "bvh:traversal=beam", "bvh:traversal=stream", "bvh:traversal=single",
                                "bvh:traversal=stream,plane_bits=8", "bvh:traversal=single,plane_bits=5", "bvh:builder=sbvh,split_overlap=0",
                                "bvh:traversal=packet,volume=sphere", "bvh:traversal=packet,volume=obb", "bvh:traversal=packet,volume=kdop"}) {
    const test::Steps steps = test::expect_to_end_as_list(scene, rays, technique, isa, list);
    EXPECT_LE(steps.nodes, static_cast<std::uint64_t>(steps.stats.interior_nodes)) << technique;
    EXPECT_LE(steps.leaves, static_cast<std::uint64_t>(steps.stats.leaves)) << technique;
    EXPECT_GT(steps.nodes, 1u) << technique;
  }
}

INSTANTIATE_TEST_SUITE_P(Isas, BvhSteps, testing::ValuesIn(std::set{Isa::scalar, best_isa()}),
                         [](const testing::TestParamInfo<Isa>& isa) { return std::string(name(isa.param)); });

/// Directions whose components are all denormal, which cannot be made as long as others without losing t, in scenes small enough for finite t.
TEST(BvhTraversals, FindWhatRaysOfDenormalDirectionsMeet) {
  constexpr std::array<float, 9> kSpeeds{0, 0, -0.0f, 0x1p-149f, -0x1p-149f, 0x1p-148f, -0x1p-147f, 0x1p-145f, -0x1p-140f};
  for (const int exponent : {-19, -22, -25}) {
    const double unit = std::ldexp(1.0, exponent);
    const Scene scene = test::lattice_scene(8, 48, unit);
    test::Planes planes;
    for (auto& on_axis : planes) {
      for (int i = -4; i < 21; ++i) on_axis.push_back(static_cast<float>(unit * i / 2));
    }
    RayBatch rays = test::plane_rays(100000, planes);
    std::mt19937 random(12);
    for (auto& column : rays.dir) {
      for (float& d : column) d = kSpeeds[random() % kSpeeds.size()];
    }
    for (const Isa isa : kIsas) {
      if (!available(isa)) continue;
      const HitBatch list = test::answer(scene, rays, "list", isa, 64).hits;
      for (const std::string traversal : {"packet", "heap"}) {
        for (const std::string volume : {"aabb", "sphere", "obb", "kdop"}) {
          const std::string technique = "bvh:traversal=" + traversal + ",volume=" + volume;
          SCOPED_TRACE(technique + ", " + std::string(name(isa)) + ", unit 2^" + std::to_string(exponent));
          const test::Answer found = test::answer(scene, rays, technique, isa, 64);
          test::expect_as_list(found.hits, found.blocker, list);
        }
      }
    }
  }
}

TEST(BvhTraversals, NearestFirstOpensTheFewestNodes) {
  const Scene scene = test::mixed_scene(2000, 0.1);
  const RayBatch rays = test::random_rays(2000);
  for (const std::string volume : {"aabb", "sphere", "obb", "kdop"}) {
    const Counters stack = test::answer(scene, rays, "bvh:traversal=packet,volume=" + volume, Isa::scalar, 1).closest;
    const Counters heap = test::answer(scene, rays, "bvh:traversal=heap,volume=" + volume, Isa::scalar, 1).closest;
    EXPECT_LT(heap.live(Event::node_visit), stack.live(Event::node_visit)) << volume;
    EXPECT_LE(heap.live(Event::leaf_visit), stack.live(Event::leaf_visit)) << volume;
  }
}

}  // namespace
}  // namespace raymeter
