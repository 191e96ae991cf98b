#include <gtest/gtest.h>

#include "accel/registry.h"
#include "core/trace/trace.h"

namespace raymeter {
namespace {

HitBatch trace_list(const Scene& scene, const RayBatch& rays, Isa isa, int packet) {
  const TechniqueSpec spec = parse_technique("list");
  const auto structure = spec.structure->build(scene, spec.params, 1);
  const auto intersector = structure->intersector({isa, packet, spec.params});
  HitBatch hits;
  trace_closest(*intersector, rays, hits, 1);
  return hits;
}

TEST(List, FindsEveryKindOnEveryIsa) {
  Scene scene;
  scene.add_sphere({0, 0, 0}, 1);
  scene.add_triangle({10, -1, 0}, {12, -1, 0}, {11, 1, 0});
  const std::array<glm::dvec3, 4> quad{{{19, -1, 0}, {21, -1, 0}, {21, 1, 0}, {19, 1, 0}}};
  scene.add_polygon(quad);
  scene.add_cone({30, -1, 0}, 1, {30, 1, 0}, 0.5);
  RayBatch rays;
  for (const float x : {0.0f, 11.0f, 20.0f, 30.0f, 40.0f}) rays.push_back({{x, 0, -5}, 0, {0, 0, 1}, 100});
  for (const Isa isa : kIsas) {
    if (!available(isa)) continue;
    for (const int packet : {1, 3, 4, 8, 16, 64}) {
      const HitBatch hits = trace_list(scene, rays, isa, packet);
      for (int i = 0; i < 4; ++i) EXPECT_EQ(hits.prim[static_cast<std::size_t>(i)], i) << name(isa) << " packet " << packet;
      EXPECT_EQ(hits.prim[4], -1);
      EXPECT_FLOAT_EQ(hits.t[0], 4.0f);
      EXPECT_FLOAT_EQ(hits.t[1], 5.0f);
      EXPECT_FLOAT_EQ(hits.t[2], 5.0f);
      EXPECT_FLOAT_EQ(hits.t[3], 4.25f);
    }
  }
}

}  // namespace
}  // namespace raymeter
