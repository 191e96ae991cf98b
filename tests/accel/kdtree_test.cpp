#include <array>
#include <set>

#include <gtest/gtest.h>

#include "tests/support/adversarial.h"
#include "tests/support/answer.h"
#include "tests/support/grid_rays.h"
#include "tests/support/test_scenes.h"
#include "tests/support/traces.h"

namespace raymeter {
namespace {

using namespace test;

constexpr std::array<std::string_view, 5> kTechniques{"kdtree", "kdtree:traversal=packet", "kdtree:clip=off,mailbox=off", "bsp",
                                                      "bsp:traversal=packet,mailbox=off"};

std::vector<Isa> usable_isas() {
  std::vector<Isa> isas;
  for (const Isa isa : kIsas) {
    if (available(isa)) isas.push_back(isa);
  }
  return isas;
}

void expect_as_the_list(const Scene& scene, const RayBatch& rays, std::string_view technique, Isa isa, int packet, const Answer& list) {
  SCOPED_TRACE(std::string(technique) + ", " + std::string(name(isa)) + ", packet " + std::to_string(packet));
  const Answer found = answer(scene, rays, technique, isa, packet);
  expect_same_hits(found.hits, list.hits, rays);
  for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_EQ(found.blocker[i] >= 0, list.blocker[i] >= 0) << "ray " << i;
}

TEST(KdTraversal, FindsPrimitivesLeftRightAndInThePlaneThatTheRayStartsIn) {
  // Two far squares make x = 0 the plane that halves the scene; then one primitive that touches it from the left, from the right, or lies in it.
  for (const int where : {-1, 0, 1}) {
    Scene scene;
    for (const double x : {-4.0, 4.0}) scene.add_triangle({x, -4, -4}, {x, 4, -4}, {x, 0, 4});
    if (where == 0) {
      scene.add_triangle({0, -1, 2}, {0, 1, 2}, {0, 0, 3});
      scene.add_sphere({0, 0, 2.5}, 0);
    } else {
      scene.add_triangle({0, -1, 2}, {0, 1, 2}, {1.0 * where, 0, 2});
      scene.add_polygon(std::array<glm::dvec3, 4>{{{0, -1, 3}, {0, 1, 3}, {1.0 * where, 1, 3}, {1.0 * where, -1, 3}}});
      scene.add_sphere({0.5 * where, 0, -3}, 0.5);
    }
    scene.finish();
    RayBatch rays;
    for (const float dx : {0.0f, -0.0f, kDenormal, -kDenormal, 0x1p-127f, -0x1p-127f, 1e-30f, -1e-30f}) {
      for (const float dz : {1.0f, -1.0f}) {
        for (const float dy : {0.0f, -0.0f, 0.0625f}) {
          for (const float t_min : {0.0f, -8.0f}) {
            for (const float x : {0.0f, -0.0f}) rays.push_back({{x, 0, 0}, t_min, {dx, dy, dz}, kInf});
          }
        }
      }
    }
    for (const Isa isa : usable_isas()) {
      const Answer list = answer(scene, rays, "list", isa, 1);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const bool must_hit = where != 0 && rays[i].dir[0] == 0 && rays[i].dir[2] > 0;
        ASSERT_TRUE(!must_hit || list.hits.prim[i] >= 2) << "ray " << i;
      }
      for (const std::string_view technique : kTechniques) {
        for (const int packet : {1, 3, 64}) expect_as_the_list(scene, rays, technique, isa, packet, list);
      }
    }
  }
}

class KdSteps : public testing::TestWithParam<Isa> {};

/// All of them in one test, since the list's answers take as long as theirs.
TEST_P(KdSteps, AMillionAdversarialRaysVisitNoMoreNodesThanThereAreAndAgreeWithTheList) {
  const Isa isa = GetParam();
  const Scene scene = lattice_scene(8, 48);
  const RayBatch rays = lattice_rays(kAdversarialRays, 8);
  const HitBatch list = answer(scene, rays, "list", isa, 64).hits;
  for (const std::string_view technique : kTechniques) {
    SCOPED_TRACE(technique);
    const Steps steps = expect_to_end_as_list(scene, rays, technique, isa, list);
    EXPECT_LE(steps.nodes, static_cast<std::uint64_t>(steps.stats.interior_nodes));
    EXPECT_LE(steps.leaves, static_cast<std::uint64_t>(steps.stats.leaves));
    EXPECT_GT(steps.leaves, 8u) << "no ray crosses the scene";
  }
}

INSTANTIATE_TEST_SUITE_P(Isas, KdSteps, testing::ValuesIn(std::set{Isa::scalar, best_isa()}),
                         [](const testing::TestParamInfo<Isa>& isa) { return std::string(name(isa.param)); });

/// Eye rays of a picture, by squares of 8 x 8 pixels, all into one octant.
RayBatch coherent_batch() {
  RayBatch rays;
  for (int block = 0; block < 64; ++block) {
    for (int k = 0; k < 64; ++k) {
      const double x = 8 * (block % 8) + k % 8, y = 8 * (block / 8) + k / 8;
      rays.push_back(ray({-0.2, -0.3, -3}, glm::dvec3(x + 1, y + 1.5, 160) / 64.0));
    }
  }
  return rays;
}

TEST(KdTraversal, RaysOfAPacketVisitWhatTheyWouldVisitAlone) {
  const Scene scene = mixed_scene(2000, 0.05);
  const RayBatch rays = coherent_batch();
  for (const char* technique : {"kdtree:mailbox=off", "kdtree:mailbox=off,traversal=packet", "bsp:mailbox=off"}) {
    for (const Isa isa : usable_isas()) {
      SCOPED_TRACE(std::string(technique) + ", " + std::string(name(isa)));
      const Answer alone = answer(scene, rays, technique, isa, 1), together = answer(scene, rays, technique, isa, 64);
      for (const Event e : {Event::node_visit, Event::leaf_visit, Event::empty_leaf_visit, Event::prim_test, Event::prim_hit}) {
        EXPECT_EQ(together.closest.live(e), alone.closest.live(e)) << static_cast<int>(e);
      }
      if (simd_width(isa) == 1) continue;
      EXPECT_LT(together.closest.executed(Event::node_visit), together.closest.live(Event::node_visit));
      EXPECT_LT(together.closest.executed(Event::prim_test), together.closest.live(Event::prim_test));
    }
  }
}

TEST(KdTraversal, PacketsOfMixedDirectionSignsAgreeWithTheList) {
  const Scene scene = mixed_scene(400, 0.1);
  std::mt19937 random(5);
  RayBatch rays;
  for (int i = 0; i < 6400; ++i) {
    glm::dvec3 dir = 2.0 * point(random) - 1.0;
    if (i % 5 == 0) dir[i / 5 % 3] = i % 2 == 0 ? 0.0 : -0.0;
    rays.push_back(ray(i / 64 % 2 == 0 ? glm::dvec3(0.5) : point(random), dir));
  }
  for (const Isa isa : usable_isas()) {
    const Answer list = answer(scene, rays, "list", isa, 1);
    for (const std::string_view technique : kTechniques) {
      for (const int packet : {1, 7, 16, 64}) expect_as_the_list(scene, rays, technique, isa, packet, list);
    }
  }
}

TEST(KdTraversal, AMailboxThatHoldsTheSceneTestsNothingTwice) {
  Scene scene;
  for (int i = 0; i < 4; ++i) {
    const double x = 0.2 * i;
    scene.add_polygon(std::array<glm::dvec3, 4>{{{x, 0, 0}, {x + 0.4, 1, 0.2}, {x + 0.4, 1, 1}, {x, 0, 0.8}}});
  }
  scene.finish();
  const RayBatch rays = random_rays(10000);
  for (const Isa isa : usable_isas()) {
    for (const int packet : {1, 64}) {
      const Answer with = answer(scene, rays, "bsp:mailbox=on", isa, packet), without = answer(scene, rays, "bsp:mailbox=off", isa, packet);
      expect_same_hits(with.hits, without.hits, rays);
      EXPECT_LE(with.closest.live(Event::prim_test), 4u * rays.size());
      EXPECT_LT(with.closest.live(Event::prim_test), without.closest.live(Event::prim_test));
      EXPECT_EQ(with.closest.live(Event::leaf_visit), without.closest.live(Event::leaf_visit));
    }
  }
}

}  // namespace
}  // namespace raymeter
