// What must not change a bit, whatever the truth is: the unit of length, mirrored and turned axes, another place, the order of primitives, rays and lanes,
// packet sizes and threads.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "experiments/verify/oracle.h"
#include "tests/support/random.h"
#include "tests/support/traces.h"

namespace raymeter {
namespace {

using glm::dvec3;
using test::Random;

constexpr float kInf = std::numeric_limits<float>::infinity();

/// A primitive that can be moved: points, and radii of spheres and cones.
struct Shape {
  PrimKind kind;
  std::array<dvec3, 4> point;
  std::array<double, 2> radius;
};

struct World {
  std::vector<Shape> shapes;
  std::vector<Ray> rays;
};

/// A map of space that lengths follow by `scale`.
struct Motion {
  std::function<dvec3(const dvec3&)> map;
  double scale = 1;
};

/// All on a lattice of 1/8, so that other places are exact; rays of any direction.
World lattice_world(bool triangles_only) {
  Random random(71);
  World world;
  const auto on_lattice = [&](double reach) { return glm::round(8.0 * random.in_cube(reach)) / 8.0; };
  for (int k = 0; k < 250; ++k) {
    const dvec3 p = on_lattice(8), e = on_lattice(2), f = on_lattice(2);
    const auto kind = triangles_only ? PrimKind::triangle : static_cast<PrimKind>(k % kPrimKindCount);
    world.shapes.push_back(
        {kind, {p, p + e, p + e + f, p + f}, {0.125 * static_cast<double>(1 + random.below(8)), 0.125 * static_cast<double>(random.below(8))}});
  }
  for (int k = 0; k < 700; ++k) {
    const dvec3 org = on_lattice(12);
    const glm::vec3 o(org), d(k % 4 == 0 ? random.direction() : on_lattice(8) + 0.1 * random.in_cube() - org);
    world.rays.push_back({{o.x, o.y, o.z}, 0, {d.x, d.y, d.z}, kInf});
  }
  return world;
}

Scene scene_of(const World& world, const Motion& motion, const std::vector<std::size_t>& order) {
  Scene scene;
  for (const std::size_t i : order) {
    const Shape& shape = world.shapes[i];
    std::array<dvec3, 4> p = shape.point;
    for (dvec3& at : p) at = motion.map(at);
    switch (shape.kind) {
      case PrimKind::sphere: scene.add_sphere(p[0], motion.scale * shape.radius[0]); break;
      case PrimKind::triangle: scene.add_triangle(p[0], p[1], p[2]); break;
      case PrimKind::polygon: scene.add_polygon(p); break;
      case PrimKind::cone: scene.add_cone(p[0], motion.scale * shape.radius[0], p[1], motion.scale * shape.radius[1]); break;
    }
  }
  scene.finish();
  return scene;
}

/// Rays with their origins mapped, and their directions as vectors, which keep their length.
RayBatch rays_of(const World& world, const Motion& motion) {
  const dvec3 zero = motion.map(dvec3(0.0));
  RayBatch rays;
  for (const Ray& ray : world.rays) {
    const glm::vec3 o(motion.map({ray.org[0], ray.org[1], ray.org[2]})), d((motion.map({ray.dir[0], ray.dir[1], ray.dir[2]}) - zero) / motion.scale);
    rays.push_back({{o.x, o.y, o.z}, ray.t_min, {d.x, d.y, d.z}, ray.t_max});
  }
  return rays;
}

std::vector<std::size_t> in_order(std::size_t count) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  return order;
}

std::vector<std::size_t> shuffled(std::size_t count) {
  Random random(72);
  std::vector<std::size_t> order = in_order(count);
  for (std::size_t i = count; i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  return order;
}

class Metamorphic : public testing::TestWithParam<std::string> {
protected:
  [[nodiscard]] static HitBatch trace(const Scene& scene, const RayBatch& rays, Isa isa, int packet = 8, int threads = 1) {
    const TechniqueSpec spec = parse_technique(GetParam());
    const auto structure = spec.structure->build(scene, spec.params, threads);
    const auto intersector = structure->intersector({isa, packet, spec.params});
    intersector->prepare(rays.view(), Query::closest, threads);
    HitBatch hits;
    trace_closest(*intersector, rays, hits, threads);
    return hits;
  }
  [[nodiscard]] static Column<std::int32_t> trace_blockers(const Scene& scene, const RayBatch& rays, Isa isa, int packet) {
    const TechniqueSpec spec = parse_technique(GetParam());
    const auto structure = spec.structure->build(scene, spec.params, 1);
    const auto intersector = structure->intersector({isa, packet, spec.params});
    intersector->prepare(rays.view(), Query::any, 1);
    Column<std::int32_t> blockers;
    trace_any(*intersector, rays, blockers, 1);
    return blockers;
  }
  /// Equal bits where t is scaled by that.
  static void expect_same(const HitBatch& hits, const HitBatch& expected, float t_scale = 1) {
    for (std::size_t i = 0; i < hits.size(); ++i) {
      ASSERT_EQ(hits.prim[i], expected.prim[i]) << "ray " << i;
      ASSERT_EQ(std::bit_cast<std::uint32_t>(hits.t[i]), std::bit_cast<std::uint32_t>(expected.t[i] * t_scale)) << "ray " << i;
      ASSERT_EQ(std::bit_cast<std::uint32_t>(hits.u[i]), std::bit_cast<std::uint32_t>(expected.u[i])) << "ray " << i;
      ASSERT_EQ(std::bit_cast<std::uint32_t>(hits.v[i]), std::bit_cast<std::uint32_t>(expected.v[i])) << "ray " << i;
    }
  }
  /// The hits of the moved world against those of the world as it is.
  static void expect_unmoved(const World& world, const Motion& motion, Isa isa) {
    const auto order = in_order(world.shapes.size());
    const Motion still{[](const dvec3& p) { return p; }};
    const HitBatch expected = trace(scene_of(world, still, order), rays_of(world, still), isa);
    ASSERT_GT(std::count_if(expected.prim.begin(), expected.prim.end(), [](std::int32_t prim) { return prim >= 0; }), 200);
    expect_same(trace(scene_of(world, motion, order), rays_of(world, motion), isa), expected, static_cast<float>(motion.scale));
  }
};

template <class Check>
void on_each_isa(Check&& check) {
  for (const Isa isa : kIsas) {
    if (!available(isa)) continue;
    SCOPED_TRACE(name(isa));
    check(isa);
    if (testing::Test::HasFailure()) return;
  }
}

TEST_P(Metamorphic, UnitOfLength) {
  const World world = lattice_world(false);
  on_each_isa([&](Isa isa) {
    for (const double scale : {0x1p-30, 0x1p-7, 0x1p9, 0x1p40}) expect_unmoved(world, {[=](const dvec3& p) { return scale * p; }, scale}, isa);
  });
}

TEST_P(Metamorphic, MirroredAxes) {
  const World world = lattice_world(false);
  on_each_isa([&](Isa isa) {
    for (const dvec3& sign : {dvec3(-1, 1, 1), dvec3(1, -1, 1), dvec3(1, 1, -1), dvec3(-1, -1, -1)}) {
      expect_unmoved(world, {[=](const dvec3& p) { return sign * p; }}, isa);
    }
  });
}

/// Axes in another order.
Motion permuted(glm::length_t x, glm::length_t y, glm::length_t z) {
  return {[=](const dvec3& p) { return dvec3(p[x], p[y], p[z]); }};
}
const std::array kTurns{permuted(1, 2, 0), permuted(2, 0, 1)};
const std::array kOddPermutations{permuted(1, 0, 2), permuted(0, 2, 1), permuted(2, 1, 0)};

// Triangles know no axis but the ray's largest. Where two axes are exchanged, so are the products of a difference: it is the same but for its sign in double,
// while FMA keeps one product exact and rounds the other.
TEST_P(Metamorphic, PermutedAxesOfTriangles) {
  const World world = lattice_world(true);
  on_each_isa([&](Isa isa) {
    for (const Motion& turn : kTurns) expect_unmoved(world, turn, isa);
    if (isa >= Isa::avx2) return;
    for (const Motion& permutation : kOddPermutations) expect_unmoved(world, permutation, isa);
  });
}

/// All kinds, and rays whose largest components are equally large: which of them a ray is seen along depends on their order.
World world_with_ties() {
  World world = lattice_world(false);
  Random random(73);
  for (int k = 0; k < 200; ++k) {
    const dvec3 org = glm::round(8.0 * random.in_cube(12)) / 8.0;
    const glm::vec3 o(org);
    const float size = static_cast<float>(1 + random.below(4)), third = k % 4 == 0 ? size : static_cast<float>(random.uniform(-1, 1)) * size;
    float d[3] = {o.x < 0 ? size : -size, o.y < 0 ? size : -size, o.z < 0 ? std::abs(third) : -std::abs(third)};
    std::rotate(d, d + k % 3, d + 3);
    world.rays.push_back({{o.x, o.y, o.z}, 0, {d[0], d[1], d[2]}, kInf});
  }
  return world;
}

TEST_P(Metamorphic, PermutedAxesOfAllKindsAsByTheList) {
  const World world = world_with_ties();
  const TechniqueSpec list = parse_technique("list");
  for (const Motion& permutation : {kTurns[0], kTurns[1], kOddPermutations[0], kOddPermutations[1], kOddPermutations[2]}) {
    const Scene scene = scene_of(world, permutation, in_order(world.shapes.size()));
    const RayBatch rays = rays_of(world, permutation);
    const auto structure = list.structure->build(scene, list.params, 1);
    on_each_isa([&](Isa isa) {
      HitBatch expected;
      trace_closest(*structure->intersector({isa, 8, list.params}), rays, expected, 1);
      expect_same(trace(scene, rays, isa), expected);
    });
  }
}

TEST_P(Metamorphic, AnotherPlace) {
  const World world = lattice_world(false);
  on_each_isa([&](Isa isa) {
    for (const dvec3& by : {dvec3(0x1p20, 0x1p20, 0x1p20), dvec3(-1024, 0.125, 0x1p18)}) expect_unmoved(world, {[=](const dvec3& p) { return p + by; }}, isa);
  });
}

TEST_P(Metamorphic, OrderOfPrimitives) {
  const World world = lattice_world(false);
  const Motion still{[](const dvec3& p) { return p; }};
  const auto order = shuffled(world.shapes.size());
  on_each_isa([&](Isa isa) {
    const RayBatch rays = rays_of(world, still);
    const HitBatch expected = trace(scene_of(world, still, in_order(world.shapes.size())), rays, isa);
    HitBatch hits = trace(scene_of(world, still, order), rays, isa);
    for (std::int32_t& prim : hits.prim) prim = prim < 0 ? prim : static_cast<std::int32_t>(order[static_cast<std::size_t>(prim)]);
    expect_same(hits, expected);
  });
}

TEST_P(Metamorphic, OrderOfRaysPacketsAndThreads) {
  const World world = lattice_world(false);
  const Motion still{[](const dvec3& p) { return p; }};
  const Scene scene = scene_of(world, still, in_order(world.shapes.size()));
  RayBatch rays = rays_of(world, still);
  while (rays.size() < 5000) rays.append(RayBatch(rays));  // several slices
  const auto order = shuffled(rays.size());
  RayBatch other;
  for (const std::size_t i : order) other.push_back(rays[i]);
  on_each_isa([&](Isa isa) {
    const HitBatch expected = trace(scene, rays, isa, 1);
    for (const auto& [packet, threads] : {std::pair{3, 2}, {kMaxPacket, 7}}) {
      const HitBatch shuffled_hits = trace(scene, other, isa, packet, threads);
      HitBatch hits;
      hits.resize(rays.size());
      for (std::size_t k = 0; k < order.size(); ++k) {
        hits.t[order[k]] = shuffled_hits.t[k];
        hits.prim[order[k]] = shuffled_hits.prim[k];
        hits.u[order[k]] = shuffled_hits.u[k];
        hits.v[order[k]] = shuffled_hits.v[k];
      }
      expect_same(hits, expected);
    }
  });
}

/// Every way in which a ray is none: what a number of it may not be in each of them, no direction, an empty interval.
std::vector<std::function<void(Ray&)>> spoilers() {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  std::vector<std::function<void(Ray&)>> ways;
  for (std::size_t a = 0; a < 3; ++a) {
    for (const float number : {kNan, kInf, -kInf}) {
      ways.emplace_back([=](Ray& ray) { ray.org[a] = number; });
      ways.emplace_back([=](Ray& ray) { ray.dir[a] = number; });
    }
  }
  for (const float zero : {0.0f, -0.0f}) ways.emplace_back([=](Ray& ray) { std::fill(ray.dir, ray.dir + 3, zero); });
  ways.emplace_back([=](Ray& ray) { ray.t_min = kNan; });
  ways.emplace_back([=](Ray& ray) { ray.t_max = kNan; });
  ways.emplace_back([](Ray& ray) { ray.t_max = -kInf; });
  ways.emplace_back([](Ray& ray) {
    ray.t_min = kInf;
    ray.t_max = 1e30f;
  });
  ways.emplace_back([](Ray& ray) { ray.t_max = std::nextafter(ray.t_min, -kInf); });
  return ways;
}

TEST_P(Metamorphic, InvalidRaysLeaveTheOtherLanesAlone) {
  const World world = lattice_world(false);
  const Motion still{[](const dvec3& p) { return p; }};
  const Scene scene = scene_of(world, still, in_order(world.shapes.size()));
  const RayBatch rays = rays_of(world, still);
  RayBatch spoilt = rays;
  const auto ways = spoilers();
  std::vector<std::size_t> way(rays.size(), ways.size());  // ways.size(): none
  for (std::size_t i = 0; i < rays.size(); i += 3) {       // 3 and the registers' widths have no common divisor: every lane gets some
    way[i] = i / 3 % ways.size();
    Ray ray = rays[i];
    ways[way[i]](ray);
    spoilt.set(i, ray);
  }
  on_each_isa([&](Isa isa) {
    HitBatch expected = trace(scene, rays, isa, 1);
    std::set<std::size_t> would_hit;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (way[i] == ways.size()) continue;
      if (expected.prim[i] >= 0) would_hit.insert(way[i]);
      expected.t[i] = kInf;
      expected.prim[i] = -1;
      expected.u[i] = expected.v[i] = 0;
    }
    ASSERT_EQ(would_hit.size(), ways.size()) << "a way that is tried on misses only tells nothing";
    for (const int packet : {1, simd_width(isa), kMaxPacket}) {
      expect_same(trace(scene, spoilt, isa, packet), expected);
      const Column<std::int32_t> blockers = trace_blockers(scene, spoilt, isa, packet);
      for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_EQ(blockers[i] >= 0, expected.prim[i] >= 0) << "ray " << i << " packet " << packet;
      for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_TRUE(blockers[i] >= 0 || blockers[i] == -1) << "ray " << i << " packet " << packet;
    }
  });
}

/// Kernels of other kinds than triangles add up over axes in their order, and so does the shear where components tie: hits of the scene with permuted axes may
/// differ from the others in what is declared, no more: both are right by exact truth, so that other primitives are near-ties.
TEST(MetamorphicTruth, PermutedAxesOfAllKindsAgreeWithinTheDeclaredErrors) {
  const World world = world_with_ties();
  const auto order = in_order(world.shapes.size());
  const Motion still{[](const dvec3& p) { return p; }};
  const TechniqueSpec list = parse_technique("list");
  const auto traced = [&](const Scene& scene, const RayBatch& rays, Isa isa) {
    HitBatch hits;
    trace_closest(*list.structure->build(scene, list.params, 1)->intersector({isa, 8, list.params}), rays, hits, 1);
    return hits;
  };
  const Scene scene = scene_of(world, still, order);
  const RayBatch rays = rays_of(world, still);
  const Oracle truth(scene);
  int others = 0, other_prims = 0;
  on_each_isa([&](Isa isa) {
    const HitBatch expected = traced(scene, rays, isa);
    for (const Motion& permutation : {kTurns[0], kTurns[1], kOddPermutations[0], kOddPermutations[1], kOddPermutations[2]}) {
      const HitBatch hits = traced(scene_of(world, permutation, order), rays_of(world, permutation), isa);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        other_prims += hits.prim[i] != expected.prim[i];
        if (hits.prim[i] == expected.prim[i] && hits.t[i] == expected.t[i]) continue;
        ++others;
        ASSERT_EQ(truth.closest(rays[i], hits.t[i], hits.prim[i]).verdict, Verdict::correct) << "ray " << i;
        ASSERT_EQ(truth.closest(rays[i], expected.t[i], expected.prim[i]).verdict, Verdict::correct) << "ray " << i;
      }
    }
  });
  EXPECT_GT(others, 0) << "kinds and ties that no order of axes touches tell nothing";
  RecordProperty("others", others);
  RecordProperty("other_prims", other_prims);
}

INSTANTIATE_TEST_SUITE_P(Structures, Metamorphic, testing::ValuesIn(test::all_traversals()),
                         [](const testing::TestParamInfo<std::string>& technique) { return test::test_name(technique.param); });

}  // namespace
}  // namespace raymeter
