#include <gtest/gtest.h>

#include <cmath>

#include "accel/registry.h"
#include "accel/weak_settings.h"
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
  for (const char* weak : {"bvh:box_test=unpadded", "bvh:box_test=fma", "bvh:triangle_test=woop", "bvh:triangle_test=moeller_trumbore,precision=double",
                           "bvh:triangle_test=pluecker", "bvh:sphere_test=naive", "bvh:sphere_test=haines"}) {
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
          "bvh:triangle_test=moeller_trumbore,precision=double", "bvh:triangle_test=pluecker", "bvh:sphere_test=naive", "bvh:sphere_test=haines"}) {
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

}  // namespace
}  // namespace raymeter
