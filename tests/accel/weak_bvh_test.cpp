#include <gtest/gtest.h>

#include <cmath>

#include "accel/registry.h"
#include "accel/weak_settings.h"
#include "core/scene/unit_triangles.h"
#include "tests/support/answer.h"

namespace raymeter {
namespace {

using test::answer;

bool answers_for_itself(std::string_view technique) {
  const StructureEntry& bvh = structure_entry("bvh");
  return answers_for_itself(bvh, parse_technique(technique).params);
}

TEST(WeakTests, AnswerForThemselvesAndNothingElseDoes) {
  for (const StructureEntry& entry : structures()) EXPECT_FALSE(raymeter::answers_for_itself(entry, entry.resolve({}))) << entry.name;
  for (const char* weak :
       {"bvh:box_test=unpadded", "bvh:box_test=fma", "bvh:triangle_test=woop", "bvh:triangle_test=moeller_trumbore,precision=double",
        "bvh:triangle_test=pluecker", "bvh:triangle_test=pluecker,triangle_epsilon=1", "bvh:triangle_test=baldwin_weber", "bvh:sphere_test=naive",
        "bvh:sphere_test=haines", "bvh:reciprocal=estimate", "bvh:reciprocal=none", "bvh:box_test=unpadded,box_padding=3", "bvh:box_bounds=tight"}) {
    EXPECT_TRUE(answers_for_itself(weak)) << weak;
  }
  for (const char* robust : {"bvh:box_test=padded", "bvh:traversal=heap", "bvh:volume=kdop", "bvh:traversal=beam"})
    EXPECT_FALSE(answers_for_itself(robust)) << robust;
}

/// A triangle of small whole coordinates that is seen nearly edge-on: the exact weights put it at 0.994.
TEST(WeakTests, PlainDifferencesLoseDepth) {
  Scene scene;
  scene.add_triangle({6, 4, 1}, {1, 0, 4}, {0, 1, 5});
  scene.finish();
  RayBatch rays;
  rays.push_back({{5, 5, 2}, 0, {-0.6477844715118408f, -1.9541897773742676f, 0.0695679634809494f}, std::numeric_limits<float>::infinity()});
  EXPECT_NEAR(answer(scene, rays, "bvh", Isa::scalar, 1).hits.t[0], 0.99414f, 1e-4f);
  EXPECT_NEAR(answer(scene, rays, "bvh:triangle_test=woop", Isa::scalar, 1).hits.t[0], 0.81875f, 1e-4f);
}

/// Where nothing is near a decision, all tests see the same.
TEST(WeakTests, AgreeWhereNothingIsClose) {
  Scene scene;
  scene.add_triangle({-1, -1, 4}, {2, -1, 4}, {-1, 2, 4});
  scene.add_sphere({0, 0, 8}, 1);
  scene.finish();
  RayBatch rays;
  for (int i = 0; i < 40; ++i) rays.push_back({{0.01f * float(i), 0.02f, 0}, 0, {0.01f, 0.02f, 1}, std::numeric_limits<float>::infinity()});
  for (int i = 0; i < 40; ++i) rays.push_back({{0.01f * float(i), 0.02f, 12}, 0, {0.01f, 0.02f, -1}, std::numeric_limits<float>::infinity()});
  for (const Isa isa : kIsas) {
    if (!available(isa)) continue;
    const auto robust = answer(scene, rays, "bvh", isa, 16);
    for (const char* technique :
         {"bvh:box_test=unpadded", "bvh:box_test=fma", "bvh:triangle_test=woop", "bvh:triangle_test=moeller_trumbore",
          "bvh:triangle_test=moeller_trumbore,precision=double", "bvh:triangle_test=pluecker", "bvh:triangle_test=baldwin_weber", "bvh:sphere_test=naive",
          "bvh:sphere_test=haines", "bvh:reciprocal=newton", "bvh:reciprocal=estimate", "bvh:reciprocal=none", "bvh:box_bounds=tight"}) {
      for (const int packet : {1, 16, 64}) {
        const auto weak = answer(scene, rays, technique, isa, packet);
        for (std::size_t i = 0; i < rays.size(); ++i) {
          EXPECT_EQ(weak.hits.prim[i], robust.hits.prim[i]) << technique << " " << name(isa) << " " << i;
          EXPECT_NEAR(weak.hits.t[i], robust.hits.t[i], 1e-5f) << technique << " " << name(isa) << " " << i;
        }
      }
    }
  }
}

/// Rays beside an edge by two and by eight units in the last place of the weights' sum.
TEST(WeakTests, AnEpsilonWidensTriangles) {
  Scene scene;
  scene.add_triangle({0, 0, 4}, {1, 0, 4}, {0, 1, 4});
  scene.finish();
  RayBatch rays;
  for (const float x : {-0x1p-22f, -0x1p-20f}) rays.push_back({{x, 0.25f, 0}, 0, {0, 0, 1}, std::numeric_limits<float>::infinity()});
  for (const Isa isa : kIsas) {
    if (!available(isa)) continue;
    for (const char* test : {"moeller_trumbore", "pluecker"}) {
      const auto hits_with = [&](int epsilon) {
        const std::string technique = "bvh:triangle_test=" + std::string(test) + ",triangle_epsilon=" + std::to_string(epsilon);
        const auto hits = answer(scene, rays, technique, isa, 16).hits;
        return std::pair(hits.prim[0] == 0, hits.prim[1] == 0);
      };
      EXPECT_EQ(hits_with(0), std::pair(false, false)) << test << ' ' << name(isa);
      EXPECT_EQ(hits_with(1), std::pair(false, false)) << test << ' ' << name(isa);
      EXPECT_EQ(hits_with(4), std::pair(true, false)) << test << ' ' << name(isa);
      EXPECT_EQ(hits_with(16), std::pair(true, true)) << test << ' ' << name(isa);
    }
  }
}

/// Directions along an axis: an estimate of 1 / 0 is infinite, of either sign, and stays so after Newton's step.
TEST(WeakTests, EstimatesOfNothingAreInfinite) {
  Scene scene;
  scene.add_triangle({-1, -1, 4}, {3, -1, 4}, {-1, 3, 4});
  scene.add_triangle({-1, -1, 6}, {3, -1, 6}, {-1, 3, 6});
  scene.finish();
  RayBatch rays;
  for (const float zero : {0.0f, -0.0f}) rays.push_back({{0.25f, 0.25f, 0}, 0, {zero, -zero, 1}, std::numeric_limits<float>::infinity()});
  for (const Isa isa : kIsas) {
    if (!available(isa)) continue;
    for (const char* technique : {"bvh:reciprocal=newton,max_leaf_size=1", "bvh:reciprocal=estimate,max_leaf_size=1", "bvh:reciprocal=none,max_leaf_size=1"}) {
      const auto hits = answer(scene, rays, technique, isa, 16).hits;
      for (std::size_t i = 0; i < rays.size(); ++i) EXPECT_EQ(hits.t[i], 4) << technique << ' ' << name(isa);
    }
  }
}

/// Maps are exact where the triangle's inverse is; a triangle without area has none, and is met by nothing.
TEST(WeakTests, UnitTrianglesMapCorners) {
  Scene scene;
  scene.add_triangle({1, 2, 3}, {3, 2, 4}, {1, 6, 3.5});
  scene.add_triangle({1, 1, 1}, {2, 2, 2}, {3, 3, 3});
  scene.finish();
  const UnitTriangles triangles = unit_triangles(scene.pools(), 1);
  ASSERT_EQ(triangles.axis.size(), 2u);
  EXPECT_EQ(triangles.axis[0], 2);
  const glm::vec3 corners[3] = {{1, 2, 3}, {3, 2, 4}, {1, 6, 3.5}};
  const float* map = triangles.map.data();
  for (int k = 0; k < 3; ++k) {
    const glm::vec3& at = corners[k];
    EXPECT_EQ(map[0] * at.x + map[1] * at.y + map[2], k == 1 ? 1.0f : 0.0f) << k;
    EXPECT_EQ(map[3] * at.x + map[4] * at.y + map[5], k == 2 ? 1.0f : 0.0f) << k;
    EXPECT_EQ(at.z + map[6] * at.x + map[7] * at.y + map[8], 0.0f) << k;
  }
  EXPECT_TRUE(std::isnan(map[9]));
}

}  // namespace
}  // namespace raymeter
