// Bounding volumes hold what they bound, in exact arithmetic: every float is a rational, and the points of surfaces that are tried are rational too.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "core/bounds/outward_rounding.h"
#include "experiments/scenes/generators.h"
#include "tests/support/exact_volumes.h"
#include "tests/support/expect_error.h"

namespace raymeter {
namespace {

using test::error_for;
using test::Exact;
using test::holds;
using test::operator+;
using test::Random;
using test::surface_point;

TEST(OutwardRounding, GivesTheNextFloatOnItsSide) {
  constexpr float kInf = std::numeric_limits<float>::infinity(), kLeast = std::numeric_limits<float>::denorm_min();
  const auto expect_next = [](double x) {
    const float down = round_down(x), up = round_up(x);
    EXPECT_TRUE(double{down} <= x && x <= double{up}) << x;
    EXPECT_TRUE(double{down} == x ? up == down : up == std::nextafterf(down, kInf)) << x;
  };
  for (const double x : {0.0, -0.0, 1.0, 1 + 0x1p-40, 1 - 0x1p-40, 1e-50, 0x1p-149, 0x1.8p-149, 0x1p-126 + 0x1p-170, 0x1.fffffefp127, 1e300}) {
    expect_next(x);
    expect_next(-x);
  }
  EXPECT_EQ(round_up(1e-50), kLeast);
  EXPECT_EQ(round_down(-1e-50), -kLeast);
  EXPECT_EQ(round_down(1e300), std::numeric_limits<float>::max());
  Random random(7);
  for (int i = 0; i < 100'000; ++i) expect_next(std::ldexp(random.uniform() - 0.5, static_cast<int>(280 * random.uniform()) - 150));
}

std::vector<PrimRef> prims_of(const Scene& scene) {
  std::vector<PrimRef> prims;
  for (std::int32_t id = 0; id < scene.prim_id_count(); ++id) {
    if (!scene.prim(id).dropped()) prims.push_back(scene.prim(id));
  }
  return prims;
}

/// Around single primitives, pairs, runs of neighbours, and merged from halves.
template <class V>
void expect_holds(const V& volume, const Scene& scene, int tries) {
  Random random(31);
  const std::vector<PrimRef> prims = prims_of(scene);
  for (int k = 0; k < tries; ++k) {
    const std::size_t first = random.below(prims.size()), count = std::min(prims.size() - first, std::size_t{1} << random.below(6));
    const std::span<const PrimRef> some(prims.data() + first, count);
    auto merged = volume.fit(scene, some.front());
    for (const PrimRef prim : some.subspan(1)) merged = volume.merge(merged, volume.fit(scene, prim));
    const auto tight = volume.fit(scene, some);
    for (int point = 0; point < 8; ++point) {
      const PrimRef prim = some[random.below(count)];
      const Exact p = surface_point(scene.pools(), prim, random) + error_for(volume, tight_bounds(scene.pools(), prim), random);
      ASSERT_TRUE(holds(volume, volume.fit(scene, prim), p)) << scene.name << " try " << k << " kind " << prim.kind_bits;
      ASSERT_TRUE(holds(volume, tight, p)) << scene.name << " try " << k << " of " << count;
      ASSERT_TRUE(holds(volume, merged, p)) << scene.name << " try " << k << " of " << count;
    }
  }
}

void expect_all_hold(const Scene& scene, int tries) {
  expect_holds(AabbVolume{}, scene, tries);
  expect_holds(SphereVolume{false}, scene, tries);
  expect_holds(SphereVolume{true}, scene, tries / 4);
  for (const ObbAxes axes : {ObbAxes::object, ObbAxes::pca, ObbAxes::best}) expect_holds(ObbVolume{axes}, scene, tries);
  for (const int k : {6, 8, 12, 14, 18, 20, 26}) expect_holds(KdopVolume(scene, k), scene, tries / 4);
  expect_holds(KdopVolume(scene, "1 0.25 0/-0.5 2 0.125/3 1 -4/0 0 1"), scene, tries);
}

TEST(BoundingVolumes, HoldTheirPrimitives) {
  for (const SceneGenerator& generator : scene_generators()) {
    Scene scene = generator.make(std::min(generator.default_size, std::max(generator.min_size, 3)));
    scene.name = std::string(generator.spec_prefix);
    expect_all_hold(scene, 60);
  }
}

TEST(BoundingVolumes, HoldPrimitivesOfAnySize) {
  Random random(32);
  Scene scene;
  const auto magnitude = [&] { return std::pow(10.0, random.uniform(-8, 8)); };
  for (int i = 0; i < 4000; ++i) {
    const double size = magnitude();
    const glm::dvec3 p = magnitude() * random.in_cube(), e = size * random.direction(), f = size * random.uniform(0, 1) * random.direction();
    const std::array<glm::dvec3, 4> quad{p, p + e, p + e + f, p + f};
    switch (i % 4) {
      case 0: scene.add_triangle(p, p + e, p + f); break;
      case 1: scene.add_sphere(p, size); break;
      case 2: scene.add_cone(p, size * random.uniform(), p + f, size * random.uniform()); break;
      default: scene.add_polygon(quad);
    }
  }
  scene.finish();
  expect_all_hold(scene, 1000);
}

TEST(BoundingVolumes, AreAsTightAsTheirKindAllows) {
  Scene scene;
  scene.add_sphere({1, 2, 3}, 2);
  scene.begin_object("tilted", glm::dmat4(glm::dvec4(0.6, 0.8, 0, 0), glm::dvec4(-0.8, 0.6, 0, 0), glm::dvec4(0, 0, 1, 0), glm::dvec4(0, 0, 0, 1)));
  scene.add_triangle({0, 0, 0}, {6, 8, 0}, {-0.8, 0.6, 0});
  scene.end_object();
  scene.add_cone({0, 0, 0}, 1, {0, 0, 4}, 1);
  scene.finish();
  const double padding = 2 * double{kSurfaceError};  // of the diagonal, on either side
  EXPECT_NEAR(SphereVolume{}.fit(scene, scene.prim(0)).radius, 2, padding * 7);
  EXPECT_NEAR(SphereVolume{}.fit(scene, scene.prim(2)).radius, std::sqrt(5.0), padding * 5);
  EXPECT_NEAR(SphereVolume{true}.fit(scene, scene.prim(1)).radius, std::sqrt(101.0) / 2, 0.01 * 5);  // to a percent, as declared
  for (const ObbAxes axes : {ObbAxes::object, ObbAxes::best}) {
    const ObbVolume obb{axes};
    EXPECT_NEAR(obb.half_area(obb.fit(scene, scene.prim(1))), 10 * 1, padding * 10.6 * (2 * 10 + 2 * 1)) << static_cast<int>(axes);
  }
  const ObbVolume pca{ObbAxes::pca};
  EXPECT_NEAR(pca.half_area(pca.fit(scene, scene.prim(2))), 2 * 2 + 2 * 4 + 4 * 2, padding * 5.1 * (2 * 2 + 2 * 2 + 2 * 4));
}

TEST(BoundingVolumes, KnowWhatTheyEnclose) {
  Scene scene;
  scene.add_sphere({5, -3, 8}, 1);
  scene.finish();
  const auto enclosed = [&](const auto& volume) { return volume.enclosed(volume.fit(scene, scene.prim(0))); };
  const double kRoundings = 3 * double{kSurfaceError} * std::sqrt(12.0) * 1.01 * 14;  // the padding on a radius of 1 changes a volume three times as much
  EXPECT_NEAR(enclosed(AabbVolume{}), 8, kRoundings);
  EXPECT_NEAR(enclosed(ObbVolume{}), 8, kRoundings);
  EXPECT_NEAR(enclosed(SphereVolume{}), 4 * std::numbers::pi / 3, kRoundings);
  EXPECT_NEAR(enclosed(KdopVolume(scene, 6)), 8, kRoundings);
  EXPECT_NEAR(enclosed(KdopVolume(scene, 8)), 4 * std::sqrt(3.0), kRoundings);           // octahedron of inradius 1
  EXPECT_NEAR(enclosed(KdopVolume(scene, 12)), 4 * std::sqrt(2.0), kRoundings);          // rhombic dodecahedron of inradius 1
  EXPECT_NEAR(enclosed(KdopVolume(scene, "1 0 0/0 1 0/0.6 0 0.8")), 2 * 5, kRoundings);  // prism of height 2 over a rhombus
}

TEST(Kdop, AreaIsThatOfItsPolytope) {
  Scene scene;
  scene.add_sphere({5, -3, 8}, 1);
  scene.finish();
  const auto area = [&](const KdopVolume& volume) { return 2 * volume.half_area(volume.fit(scene, scene.prim(0))); };
  const double kRoundings = 2 * double{kSurfaceError} * std::sqrt(12.0) * 1.01 * 30;               // the padding on a radius of 1 changes an area twice as much
  EXPECT_NEAR(area(KdopVolume(scene, 6)), 24, kRoundings);                                         // cube
  EXPECT_NEAR(area(KdopVolume(scene, 8)), 12 * std::sqrt(3.0), kRoundings);                        // octahedron of inradius 1
  EXPECT_NEAR(area(KdopVolume(scene, 12)), 12 * std::sqrt(2.0), kRoundings);                       // rhombic dodecahedron of inradius 1
  EXPECT_NEAR(area(KdopVolume(scene, "1 0 0/0 1 0/0.6 0 0.8")), 2 * 5 + 4 * 2.5 * 2, kRoundings);  // prism of height 2 over a rhombus
  const double finest = area(KdopVolume(scene, 26));
  EXPECT_GT(finest, 4 * 3.14159);
  EXPECT_LT(finest, area(KdopVolume(scene, 18)));
}

/// Half the area by another way: meets of three planes each, and each face as those that lie on it in the order of their angles.
double half_area_by_vertices(const KdopVolume& volume, const Kdop& kdop) {
  std::vector<std::pair<glm::dvec3, double>> planes;
  double widest = 0;
  for (std::size_t i = 0; i < volume.directions().size(); ++i) {
    planes.emplace_back(volume.directions()[i], kdop.max[i]);
    planes.emplace_back(-volume.directions()[i], -kdop.min[i]);
    widest = std::max(widest, double{kdop.max[i]} - double{kdop.min[i]});
  }
  const double close = 1e-10 * widest;
  double area = 0;
  for (std::size_t f = 0; f < planes.size(); ++f) {
    std::vector<glm::dvec3> corners;
    glm::dvec3 middle(0.0);
    for (std::size_t g = 0; g < planes.size(); ++g) {
      for (std::size_t h = g + 1; h < planes.size(); ++h) {
        const glm::dmat3 rows = glm::transpose(glm::dmat3(planes[f].first, planes[g].first, planes[h].first));
        if (std::abs(glm::determinant(rows)) < 1e-9) continue;
        const glm::dvec3 at = glm::inverse(rows) * glm::dvec3(planes[f].second, planes[g].second, planes[h].second);
        if (!std::ranges::all_of(planes, [&](const auto& plane) { return glm::dot(plane.first, at) <= plane.second + close; })) continue;
        corners.push_back(at);
        middle += at;
      }
    }
    if (corners.size() < 3) continue;
    middle /= static_cast<double>(corners.size());
    const glm::dvec3 normal = glm::normalize(planes[f].first);
    const glm::dvec3 x = glm::normalize(glm::cross(normal, std::abs(normal.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0))), y = glm::cross(normal, x);
    const auto angle = [&](const glm::dvec3& at) { return std::atan2(glm::dot(at - middle, y), glm::dot(at - middle, x)); };
    std::ranges::sort(corners, {}, angle);
    for (std::size_t k = 0; k < corners.size(); ++k) area += glm::dot(normal, glm::cross(corners[k] - middle, corners[(k + 1) % corners.size()] - middle)) / 2;
  }
  return area / 2;
}

TEST(Kdop, AreaIsThatOfThePolytopesVertices) {
  Random random(11);
  for (const std::size_t layers : {5U, 2U, 1U}) {  // of a grid, where many planes go through the same corners and edges
    for (const int k : {6, 8, 12, 14, 18, 20, 26}) {
      const KdopVolume volume(Scene(), k);
      for (int i = 0; i < 200; ++i) {
        Kdop kdop;
        kdop.min.fill(std::numeric_limits<float>::infinity());
        kdop.max.fill(-std::numeric_limits<float>::infinity());
        for (std::size_t point = 0; point < 2 + random.below(5); ++point) {
          const glm::vec3 at(random.below(9), random.below(9), random.below(layers));
          for (std::size_t s = 0; s < volume.directions().size(); ++s) {
            kdop.min[s] = std::min(kdop.min[s], glm::dot(volume.directions()[s], at));
            kdop.max[s] = std::max(kdop.max[s], glm::dot(volume.directions()[s], at));
          }
        }
        EXPECT_NEAR(volume.half_area(kdop), half_area_by_vertices(volume, kdop), 1e-7) << "k " << k << ", layers " << layers << ", " << i;
      }
    }
  }
}

TEST(Kdop, DirectionsThatDoNotSpanSpaceAreErrors) {
  const Scene scene;
  const auto error_of = [&](std::string_view text, const std::string& why) {
    expect_error_message([&] { (void)KdopVolume(scene, text); },
                         "directions: '" + std::string(text) + "': " + why + ", expected 3 to 13 vectors that span space, as in 1 0 0/0 1 0/0 0.6 0.8");
  };
  error_of("1 0 0/0 1 0/1 1 0", "they do not span space");
  error_of("1 0 0/0 1 0", "2 vectors");
  error_of("1 0 0/0 1 0/0 0 0", "a direction is zero or infinite");
  error_of("1 0 0/0 1/0 0 1", "three numbers are missing at position 9");
  error_of("1 0 0;0 1 0", "unexpected ';'");
  expect_error_message([&] { (void)KdopVolume(scene, 10); }, "k: 10, expected 6, 8, 12, 14, 18, 20 or 26");
}

}  // namespace
}  // namespace raymeter
