#include <gtest/gtest.h>

#include <limits>

#include "accel/bvh/coherence.h"
#include "accel/registry.h"
#include "core/trace/trace.h"
#include "tests/support/test_rays.h"
#include "tests/support/test_scenes.h"
#include "tests/support/traces.h"

namespace raymeter {
namespace {

using test::Traced;

RayBatch fan(int count, double spread, double length) {
  RayBatch rays;
  for (int i = 0; i < count; ++i) rays.push_back(test::make_ray({0, 0, -5}, length * glm::dvec3(spread * (i % 4 - 1.5), spread * (i / 4 % 4 - 1.5), 1)));
  return rays;
}

TEST(Coherence, IsTheLengthOfTheMeanDirection) {
  EXPECT_NEAR(coherence(fan(1000, 0, 3).view(), 8), 1, 1e-6);
  EXPECT_NEAR(coherence(fan(1000, 0, 1e-15).view(), 8), 1, 1e-6);
  EXPECT_GT(coherence(fan(1000, 0.01, 1).view(), 8), 0.99);
  EXPECT_LT(coherence(fan(1000, 2, 1).view(), 8), 0.5);
  RayBatch opposite;
  for (int i = 0; i < 64; ++i) opposite.push_back(test::make_ray({0, 0, 0}, {0, 0, i % 2 == 0 ? 1 : -1}));
  EXPECT_NEAR(coherence(opposite.view(), 4), 0, 1e-6);
}

TEST(Coherence, LeavesOutWhatIsNoRay) {
  RayBatch rays = fan(16, 0, 1);
  rays.set(3, test::make_ray({0, 0, 0}, {0, 0, 0}));
  rays.set(9, test::make_ray({0, 0, 0}, {std::numeric_limits<double>::quiet_NaN(), 0, 1}));
  EXPECT_NEAR(coherence(rays.view(), 4), 1, 1e-6);
  EXPECT_EQ(coherence(RayBatch().view(), 4), 1);
}

TEST(AutoTraversal, ChoosesForEachSliceAndSaysWhat) {
  const Scene& scene = test::scene_named("mixed");
  const TechniqueSpec spec = parse_technique("bvh:traversal=auto");
  const auto structure = spec.structure->build(scene, spec.params, 1);
  const RayBatch near = fan(1024, 0.001, 1), wide = fan(1024, 2, 1);
  RayBatch both = near;
  both.append(wide);
  const auto choice = [&](const RayBatch& rays, int packet) {
    const auto intersector = structure->intersector({best_isa(), packet, spec.params});
    intersector->prepare(rays.view(), Query::closest, 1);
    EXPECT_EQ(intersector->choice(Query::any), "");
    return intersector->choice(Query::closest);
  };
  EXPECT_EQ(choice(near, kMaxPacket), "traversal=beam");
  EXPECT_EQ(choice(near, 1), "traversal=stream");
  EXPECT_EQ(choice(wide, kMaxPacket), "traversal=stream");
  EXPECT_EQ(choice(both, kMaxPacket), "traversal=beam|stream");

  const auto work = [&](const char* technique, const RayBatch& rays, int threads) {
    const TechniqueSpec one = parse_technique(technique);
    return test::trace(*structure, {best_isa(), kMaxPacket, one.params}, rays, threads);
  };
  Traced beam = work("bvh:traversal=beam", near, 1), stream = work("bvh:traversal=stream", wide, 1);
  beam.closest.add(stream.closest);
  for (const int threads : {1, 2, 7}) {
    const Traced found = work("bvh:traversal=auto", both, threads);
    test::expect_same_hits(found.hits, test::trace_list(scene, best_isa(), both).hits, both);
    beam.closest.ray_count = found.closest.ray_count;
    EXPECT_EQ(found.closest, beam.closest) << threads;
  }
}

}  // namespace
}  // namespace raymeter
