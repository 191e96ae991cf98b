// Numerics case 27: scenes that are denormal as a whole, and what is too small to be seen. Every structure and builder ends and meets what is declared (C6).

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "experiments/verify/verify.h"
#include "tests/support/random.h"
#include "tests/support/test_scenes.h"
#include "tests/support/traces.h"

namespace raymeter {
namespace {

using test::Random;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr double kDeclared = 0x1p-55;  // a unit of which all is as declared

/// All kinds of primitives, up to 2 units in size, within 8 units of the origin.
Scene tiny_scene(double unit) {
  Random random(27);
  Scene scene;
  for (int k = 0; k < 40; ++k) {
    const glm::dvec3 p = unit * random.in_cube(8), e = unit * random.in_cube(2), f = unit * random.in_cube(2);
    scene.add_triangle(p, p + e, p + f);
    scene.add_sphere(p, unit * random.uniform());
    scene.add_polygon(std::array{p, p + e, p + e + f, p + f});
    scene.add_cone(p, unit * random.uniform(), p + e, unit * random.uniform());
  }
  scene.finish();
  return scene;
}

/// From within such a scene and from far outside of it, with directions as short as the way, and others.
RayBatch tiny_rays(double unit) {
  Random random(28);
  RayBatch rays;
  for (int k = 0; k < 200; ++k) {
    const glm::dvec3 at = unit * random.in_cube(8), org = at + unit * std::exp2(random.uniform(-2, k % 4 == 0 ? 100 : 4)) * random.direction();
    const glm::vec3 o(org);
    glm::dvec3 dir = at - glm::dvec3(o);
    if (k % 3 != 0) dir /= glm::length(dir);
    if (k % 5 == 0) dir[static_cast<glm::length_t>(random.below(3))] = 0;
    const glm::vec3 d(dir);
    rays.push_back({{o.x, o.y, o.z}, k % 7 == 0 ? -kInf : 0, {d.x, d.y, d.z}, kInf});
  }
  return rays;
}

HitBatch traced(const Structure& structure, const QueryOptions& options, const RayBatch& rays) {
  const auto intersector = structure.intersector(options);
  intersector->prepare(rays.view(), Query::closest, 1);
  HitBatch hits;
  trace_closest(*intersector, rays, hits, 1);
  return hits;
}

class TinyScenes : public testing::TestWithParam<std::string> {
protected:
  /// Calls check(hits, isa) for each instruction set and packets of one, some and many registers.
  template <class Check>
  static void for_each_trace(const Scene& scene, const RayBatch& rays, Check&& check) {
    const TechniqueSpec spec = parse_technique(GetParam());
    const auto structure = spec.structure->build(scene, spec.params, 1);
    for (const Isa isa : kIsas) {
      if (!available(isa)) continue;
      for (const int packet : {1, 5, kMaxPacket}) {
        SCOPED_TRACE(std::string(name(isa)) + " packet " + std::to_string(packet));
        check(traced(*structure, {isa, packet, spec.params}, rays), isa);
      }
    }
  }
};

/// Squares of lengths underflow: a sphere's box is all that is left of it, the other kinds are lost.
TEST_P(TinyScenes, DenormalOnesEndWithoutNaN) {
  for (const double unit : {0x1p-140, 0x1p-100}) {
    const Scene scene = tiny_scene(unit);
    const RayBatch rays = tiny_rays(unit);
    for_each_trace(scene, rays, [&](const HitBatch& hits, Isa) {
      for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_FALSE(std::isnan(hits.t[i]) || std::isnan(hits.u[i]) || std::isnan(hits.v[i])) << "ray " << i;
        if (hits.prim[i] < 0) continue;
        ASSERT_TRUE(std::isfinite(hits.t[i]) && hits.t[i] >= rays[i].t_min) << "ray " << i;
        ASSERT_EQ(scene.prim(hits.prim[i]).kind(), PrimKind::sphere) << "ray " << i;
      }
    });
  }
}

TEST_P(TinyScenes, AreAnsweredAsByTheListDownToTheDeclaredUnit) {
  const Scene scene = tiny_scene(kDeclared);
  const RayBatch rays = tiny_rays(kDeclared);
  const TechniqueSpec list = parse_technique("list");
  const auto structure = list.structure->build(scene, list.params, 1);
  for_each_trace(scene, rays, [&](const HitBatch& hits, Isa isa) { test::expect_same_hits(hits, traced(*structure, {isa, 1, list.params}, rays), rays); });
}

/// Case 13 at 2^-66: triangles that are all lost.
TEST_P(TinyScenes, TrianglesThatAreLostAreMissedByAll) {
  const Scene mesh = test::icosphere(3, 0x1p-66);
  RayBatch rays;
  Random random(29);
  for (int k = 0; k < 100; ++k) {
    const glm::vec3 o(0x1p-69 * random.in_cube()), d(random.direction());
    rays.push_back({{o.x, o.y, o.z}, 0, {d.x, d.y, d.z}, kInf});
  }
  for_each_trace(mesh, rays, [](const HitBatch& hits, Isa) { ASSERT_EQ(std::ranges::count(hits.prim.span(), -1), static_cast<std::ptrdiff_t>(hits.size())); });
}

INSTANTIATE_TEST_SUITE_P(Structures, TinyScenes, testing::ValuesIn([] {
                           std::vector<std::string> texts = test::all_traversals();
                           for (const char* builder : {"sweep_sah", "sbvh", "goldsmith_salmon", "lbvh", "ploc"})
                             texts.push_back(std::string("bvh:builder=") + builder);
                           return texts;
                         }()),
                         [](const testing::TestParamInfo<std::string>& technique) { return test::test_name(technique.param); });

TEST(TinyScenes, AreRightDownToTheDeclaredUnit) {
  const Scene scene = tiny_scene(kDeclared);
  const RayBatch rays = tiny_rays(kDeclared);
  const Oracle oracle(scene);
  const TechniqueSpec list = parse_technique("list");
  const auto structure = list.structure->build(scene, list.params, 1);
  for (const Isa isa : kIsas) {
    if (!available(isa)) continue;
    const Accuracy accuracy = verify_closest(oracle, rays, traced(*structure, {isa, 1, list.params}, rays), {1e9, 1, 1});
    EXPECT_EQ(accuracy.mismatches(), 0) << name(isa);
    EXPECT_EQ(accuracy.rays_checked, static_cast<std::int64_t>(rays.size()));
  }
}

}  // namespace
}  // namespace raymeter
