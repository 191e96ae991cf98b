#include "accel/bvh/quantised_nodes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "accel/registry.h"
#include "core/base/error.h"
#include "tests/support/expect_error.h"
#include "tests/support/random.h"
#include "tests/support/test_rays.h"
#include "tests/support/test_scenes.h"
#include "tests/support/traces.h"

namespace raymeter {
namespace {

using test::scene_named;
using test::Traced;

/// A node of `children` random boxes about (x, -x, x), of the given size; the first is flat, the second a point.
WideNode random_node(test::Random& random, int children, float x, float size) {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  WideNode node{};
  for (int c = 0; c < kWideChildren; ++c) {
    for (int a = 0; a < 3; ++a) {
      const float middle = (a == 1 ? -x : x) + size * static_cast<float>(random.uniform(-1, 1)),
                  half = c == 1 || (c == 0 && a == 2) ? 0 : size * static_cast<float>(random.uniform(0, 0.5));
      node.plane[a][c] = c < children ? middle - half : kInf;
      node.plane[a + 3][c] = c < children ? middle + half : -kInf;
    }
    node.child[c] = WideRef(WideRef::Tag::block, static_cast<std::size_t>(100 + c));
    node.order[c] = 0x76543210U;
  }
  node.order[5] = 0x01234567U;
  return node;
}

/// Planes as whole steps in exact arithmetic, rounded once: outside of the boxes, by less than two steps. Steps are the least that reach the far plane.
template <class Plane>
void expect_around(const WideNode& node, const QuantisedNode<Plane>& packed, int bits, int children) {
  constexpr int kLeastExponent = std::numeric_limits<float>::min_exponent - 1;
  ASSERT_EQ(packed.children, children);
  for (int a = 0; a < 3; ++a) {
    const double step = std::ldexp(1.0, packed.exponent[a]);
    if (packed.exponent[a] > kLeastExponent) {
      const float farthest = *std::max_element(node.plane[a + 3], node.plane[a + 3] + children);
      EXPECT_LT(static_cast<long double>(packed.corner[a]) + ((1 << bits) - 1) * static_cast<long double>(step / 2), farthest);
    }
    for (int c = 0; c < children; ++c) {
      ASSERT_LT(packed.plane[a + 3][c], 1 << bits);
      const auto low = static_cast<float>(static_cast<long double>(packed.corner[a]) + static_cast<long double>(packed.plane[a][c]) * step);
      const auto high = static_cast<float>(static_cast<long double>(packed.corner[a]) + static_cast<long double>(packed.plane[a + 3][c]) * step);
      EXPECT_LE(low, node.plane[a][c]);
      EXPECT_GE(high, node.plane[a + 3][c]);
      const double ulp = std::nextafter(std::abs(node.plane[a][c]), std::numeric_limits<float>::infinity()) - std::abs(node.plane[a][c]);
      EXPECT_LE(double{node.plane[a][c]} - low, 2 * std::max(step, ulp));
      EXPECT_LE(high - double{node.plane[a + 3][c]}, 2 * std::max(step, ulp));
    }
  }
}

TEST(QuantisedNodes, LieAroundTheirBoxesByLessThanTwoSteps) {
  test::Random random(5);
  for (const float x : {0.0F, 1.0F, 12345.6F, 0x1p119F}) {
    for (const float size : {0.0F, 0x1p-140F, 1e-6F, 1.0F, 1e5F}) {
      for (int i = 0; i < 50; ++i) {
        const int children = 1 + i % kWideChildren;
        const WideNode node = random_node(random, children, x, size);
        for (const int bits : {2, 5, 8, 9, 16}) {
          SCOPED_TRACE(std::to_string(x) + " size " + std::to_string(size) + " bits " + std::to_string(bits));
          const QuantisedNodes packed = quantised_nodes({&node, 1}, bits);
          ASSERT_EQ(packed.by_bytes.size(), bits <= 8 ? 1 : 0);
          ASSERT_EQ(packed.by_words.size(), bits <= 8 ? 0 : 1);
          if (bits <= 8)
            expect_around(node, packed.by_bytes[0], bits, children);
          else
            expect_around(node, packed.by_words[0], bits, children);
          if (testing::Test::HasFailure()) return;
        }
      }
    }
  }
}

TEST(QuantisedNodes, KeepChildrenAndOrders) {
  test::Random random(6);
  const WideNode node = random_node(random, 3, 0, 1);
  const QuantisedNode<std::uint8_t> packed = quantised_nodes({&node, 1}, 8).by_bytes[0];
  for (int c = 0; c < kWideChildren; ++c) EXPECT_EQ(packed.child[c].bits, node.child[c].bits);
  for (int octant = 0; octant < 8; ++octant) EXPECT_EQ(packed.order[octant], node.order[octant]);
}

TEST(QuantisedNodes, RefuseWhatIsTooFarAway) {
  test::Random random(7);
  const WideNode node = random_node(random, 2, 0x1p121F, 1);
  EXPECT_THROW((void)quantised_nodes({&node, 1}, 8), Error);
}

TEST(QuantisedBvh, EqualsListBitForBit) {
  for (const char* scene_name : {"mixed", "icosphere"}) {
    const Scene& scene = scene_named(scene_name);
    const RayBatch rays = test::hard_rays(scene, 11);
    for (const char* traversal : {"stream", "single"}) {
      for (const int bits : {2, 5, 8, 12, 16}) {
        const TechniqueSpec spec = parse_technique("bvh:traversal=" + std::string(traversal) + ",plane_bits=" + std::to_string(bits));
        const auto structure = spec.structure->build(scene, spec.params, 1);
        for (const Isa isa : kIsas) {
          if (!available(isa)) continue;
          SCOPED_TRACE(std::string(scene_name) + ' ' + traversal + ' ' + std::to_string(bits) + ' ' + name(isa).data());
          const HitBatch list = test::trace_list(scene, isa, rays).hits;
          const Traced found = test::trace(*structure, {isa, kMaxPacket, spec.params}, rays);
          test::expect_same_hits(found.hits, list, rays);
          for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_EQ(found.blockers[i] >= 0, list.prim[i] >= 0) << i;
        }
      }
    }
  }
}

/// Larger boxes are met by more rays: fewer bits cost visits of nodes and of leaves.
TEST(QuantisedBvh, VisitsMoreTheFewerBits) {
  const Scene& scene = scene_named("icosphere");
  const RayBatch rays = test::coherent_rays(scene);
  for (const Isa isa : kIsas) {
    if (!available(isa)) continue;
    std::uint64_t nodes_before = 0, leaves_before = 0, nodes_of_floats = 0;
    for (const int bits : {32, 16, 8, 5, 3, 2}) {
      const TechniqueSpec spec = parse_technique("bvh:traversal=single,plane_bits=" + std::to_string(bits));
      const Counters found = test::trace(*spec.structure->build(scene, spec.params, 1), {isa, 1, spec.params}, rays).closest;
      EXPECT_GE(found.live(Event::node_visit), nodes_before) << bits << ' ' << name(isa);
      EXPECT_GE(found.live(Event::leaf_visit), leaves_before) << bits << ' ' << name(isa);
      nodes_before = found.live(Event::node_visit);
      leaves_before = found.live(Event::leaf_visit);
      if (bits == 32) nodes_of_floats = nodes_before;
    }
    EXPECT_GT(nodes_before, nodes_of_floats) << name(isa);
  }
}

/// What all structures of a kind hold alike, themselves and the ends of their columns, is in the difference of two scenes no more.
TEST(QuantisedBvh, HasNodesOfHalfTheBytes) {
  const auto built = [](const char* scene_name, int bits) {
    const TechniqueSpec spec = parse_technique("bvh:traversal=stream,plane_bits=" + std::to_string(bits));
    return spec.structure->build(scene_named(scene_name), spec.params, 1)->stats();
  };
  const auto nodes = [&](int bits) { return built("mixed", bits).interior_nodes - built("icosphere", bits).interior_nodes; };
  const auto saved = [&](const char* scene_name, int bits) { return built(scene_name, 32).mem_bytes - built(scene_name, bits).mem_bytes; };
  ASSERT_GT(nodes(32), 0);
  for (const auto& [bits, bytes] : {std::pair{8, 128}, {16, 64}}) {
    EXPECT_EQ(nodes(bits), nodes(32));
    EXPECT_EQ(saved("mixed", bits) - saved("icosphere", bits), bytes * nodes(32)) << bits;
  }
}

TEST(QuantisedBvh, SaysWhichBitsThereAre) {
  for (const int bits : {1, 17, 20, 31, 33}) {
    expect_error_message([&] { (void)parse_technique("bvh:traversal=stream,plane_bits=" + std::to_string(bits)); },
                         "bvh:plane_bits: expected a whole number from 2 to 16 or 32, got " + std::to_string(bits));
  }
}

}  // namespace
}  // namespace raymeter
