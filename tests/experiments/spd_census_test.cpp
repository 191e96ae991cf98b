// What is known of the Standard Procedural Databases without their files: counts and extents of the original programs' output, closed forms, composite objects.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <glm/common.hpp>

#include "core/bounds/aabb.h"
#include "experiments/scenes/generators.h"

namespace raymeter {
namespace {

struct Census {
  const char* spec;
  std::size_t spheres, cones, polygons, triangles, lights, materials;
  glm::dvec3 min, max;  ///< of the geometry, to six digits
};

const Census kCensus[] = {
    {"spd:balls:2", 91, 0, 1, 0, 3, 2, {-12, -12, -0.5}, {12, 12, 0.785072}},
    {"spd:balls:3", 820, 0, 1, 0, 3, 2, {-12, -12, -0.5}, {12, 12, 0.821994}},
    {"spd:balls:4", 7381, 0, 1, 0, 3, 2, {-12, -12, -0.5}, {12, 12, 0.830567}},
    {"spd:balls:5", 66430, 0, 1, 0, 3, 2, {-12, -12, -0.5}, {12, 12, 0.833425}},
    {"spd:balls:6", 597871, 0, 1, 0, 3, 2, {-12, -12, -0.5}, {12, 12, 0.834781}},
    {"spd:gears:2", 0, 0, 1169, 0, 5, 8, {-2, -2, 0}, {2, 2, 1}},
    {"spd:gears:4", 0, 0, 9345, 0, 5, 63, {-2, -2, 0}, {2, 2, 1}},
    {"spd:gears:8", 0, 0, 74753, 0, 5, 396, {-2, -2, 0}, {2, 2, 1}},
    {"spd:jacks:1", 6, 3, 0, 0, 1, 1, {-0.854769, -0.799519, -0.760348}, {0.854769, 0.799519, 0.760348}},
    {"spd:jacks:3", 438, 219, 0, 0, 1, 1, {-1.17498, -1.33004, -1.39758}, {1.17498, 1.33004, 1.39758}},
    {"spd:jacks:5", 28086, 14043, 0, 0, 1, 1, {-1.25502, -1.46267, -1.55689}, {1.25502, 1.46267, 1.55689}},
    {"spd:lattice:12", 2197, 6084, 0, 0, 6, 4, {-0.0208333, -0.0208333, -0.0208333}, {1.02083, 1.02083, 1.02083}},
    {"spd:lattice:24", 15625, 45000, 0, 0, 6, 4, {-0.0104167, -0.0104167, -0.0104167}, {1.01042, 1.01042, 1.01042}},
    {"spd:lattice:6", 343, 882, 0, 0, 6, 4, {-0.0416667, -0.0416667, -0.0416667}, {1.04167, 1.04167, 1.04167}},
    {"spd:mount:4", 4, 0, 0, 512, 1, 2, {-1.15961, -1, -0.702953}, {1, 1.15961, 1.37821}},
    {"spd:mount:6", 4, 0, 0, 8192, 1, 2, {-1.15961, -1, -0.702953}, {1, 1.15961, 1.37821}},
    {"spd:mount:8", 4, 0, 0, 131072, 1, 2, {-1.15961, -1, -0.609727}, {1, 1.15961, 1.37821}},
    {"spd:rings:13", 24570, 24570, 1, 0, 3, 7, {-17.3982, 1.65358, -15.8982}, {15.3982, 36.5838, 16.8982}},
    {"spd:rings:3", 420, 420, 1, 0, 3, 7, {-6.46608, 1.65358, -4.96608}, {4.46608, 10.4525, 5.96608}},
    {"spd:rings:7", 4200, 4200, 1, 0, 3, 7, {-10.8389, 1.65358, -9.33895}, {8.83895, 20.905, 10.3389}},
    {"spd:shells:5", 5761, 0, 0, 0, 1, 1, {-27.3134, -21.5798, -50.706}, {17.0498, 33.804, -0.00350044}},
    {"spd:shells:7", 23041, 0, 0, 0, 1, 1, {-27.3134, -21.5799, -50.706}, {17.0498, 33.804, -0.00350044}},
    {"spd:sombrero:1", 0, 0, 0, 1922, 1, 1, {-4, -3.60653, -4}, {4, -2, 4}},
    {"spd:sombrero:3", 0, 0, 0, 32258, 1, 1, {-4, -3.61421, -4}, {4, -2, 4}},
    {"spd:teapot:12", 0, 0, 144, 9120, 2, 3, {-4, -4, 0}, {4, 4, 3.15}},
    {"spd:teapot:24", 0, 0, 576, 36672, 2, 3, {-4, -4, 0}, {4, 4, 3.15}},
    {"spd:teapot:6", 0, 0, 36, 2256, 2, 3, {-4, -4, 0}, {4, 4, 3.15}},
    {"spd:tetra:4", 0, 0, 0, 256, 1, 1, {-1, -1, -1}, {1, 1, 1}},
    {"spd:tetra:6", 0, 0, 0, 4096, 1, 1, {-1, -1, -1}, {1, 1, 1}},
    {"spd:tetra:8", 0, 0, 0, 65536, 1, 1, {-1, -1, -1}, {1, 1, 1}},
    {"spd:tetra:9", 0, 0, 0, 262144, 1, 1, {-1, -1, -1}, {1, 1, 1}},
    {"spd:tree:11", 4095, 4095, 1, 0, 7, 2, {-50, -50, 0}, {50, 50, 3.13749}},
    {"spd:tree:14", 32767, 32767, 1, 0, 7, 2, {-50, -50, 0}, {50, 50, 3.16495}},
    {"spd:tree:7", 255, 255, 1, 0, 7, 2, {-50, -50, 0}, {50, 50, 3.00205}},
};

std::size_t distinct_materials(const Scene& scene) {
  std::vector<Material> known;
  for (const Scene::MaterialRun& run : scene.material_runs())
    if (std::find(known.begin(), known.end(), run.material) == known.end()) known.push_back(run.material);
  return known.size();
}

TEST(SpdCensus, CountsAndExtentsAreThoseOfTheOriginalPrograms) {
  for (const Census& census : kCensus) {
    SCOPED_TRACE(census.spec);
    const Scene scene = generate_scene(census.spec);
    EXPECT_EQ(scene.dropped_count(), 0);
    EXPECT_EQ(scene.pools().spheres.size(), census.spheres);
    EXPECT_EQ(scene.pools().cones.size(), census.cones);
    EXPECT_EQ(scene.pools().polygons.size(), census.polygons);
    EXPECT_EQ(scene.pools().triangles.size(), census.triangles);
    EXPECT_EQ(scene.lights.size(), census.lights);
    EXPECT_EQ(distinct_materials(scene), census.materials);
    Aabb box;
    for (std::int32_t prim = 0; prim < scene.prim_id_count(); ++prim) box.grow(tight_bounds(scene.pools(), scene.prim(prim)));
    for (glm::length_t axis = 0; axis < 3; ++axis) {
      // The extents were taken from numbers of six digits (a centre and a radius, each off by 5e-6 at most) and printed with six; 1e-12 is more than what
      // tight_bounds may add to an extent of 0.
      EXPECT_NEAR(static_cast<double>(box.min[axis]), census.min[axis], 1.5e-5 * std::abs(census.min[axis]) + 1e-12) << "axis " << axis;
      EXPECT_NEAR(static_cast<double>(box.max[axis]), census.max[axis], 1.5e-5 * std::abs(census.max[axis]) + 1e-12) << "axis " << axis;
    }
  }
}

std::int64_t power(std::int64_t base, int exponent) {
  std::int64_t result = 1;
  for (int i = 0; i < exponent; ++i) result *= base;
  return result;
}

std::int64_t squares_below(std::int64_t n) { return n * (n + 1) * (2 * n + 1) / 6; }

/// The number of primitives of a database in closed form.
std::int64_t primitives(std::string_view name, int s) {
  const std::int64_t n = s;
  if (name == "spd:balls") return 1 + (power(9, s + 1) - 1) / 8;
  if (name == "spd:gears") return 1 + 146 * n * n * n;
  if (name == "spd:mount") return 4 + 2 * power(4, s);
  if (name == "spd:rings") return 1 + 60 * squares_below(n);
  if (name == "spd:teapot") return 64 * n * n - 8 * n + n * n;
  if (name == "spd:tetra") return 4 * power(4, s - 1);
  if (name == "spd:tree") return 1 + 2 * (power(2, s + 1) - 1);
  if (name == "spd:lattice") return (n + 1) * (n + 1) * (n + 1) + 3 * n * (n + 1) * (n + 1);
  if (name == "spd:shells") return 180 * power(2, s) + 1;
  if (name == "spd:jacks") return 9 * (power(8, s) - 1) / 7;
  if (name == "spd:sombrero") return 2 * (16 * power(2, s) - 1) * (16 * power(2, s) - 1);
  return -1;
}

TEST(SpdCensus, EverySizeHasItsClosedFormCount) {
  constexpr std::int64_t kLargest = 200'000;  // keeps the test short
  for (const SceneGenerator& generator : scene_generators()) {
    if (!generator.spec_prefix.starts_with("spd:")) continue;
    int tried = 0;
    for (int size = generator.min_size; size <= generator.max_size && primitives(generator.spec_prefix, size) <= kLargest; ++size, ++tried) {
      if (size > generator.min_size + 3 && size % 5 != 0) continue;
      EXPECT_EQ(generator.make(size).prim_count(), primitives(generator.spec_prefix, size)) << generator.spec_prefix << ":" << size;
    }
    EXPECT_GE(tried, 4) << generator.spec_prefix;
    EXPECT_LE(primitives(generator.spec_prefix, generator.max_size), 50'000'000) << generator.spec_prefix;
  }
}

TEST(SpdCensus, DefaultSizesAreThoseOfRelease3) {
  const std::vector<std::pair<std::string_view, int>> defaults{{"spd:balls", 4},  {"spd:gears", 4}, {"spd:mount", 6},   {"spd:rings", 7},
                                                               {"spd:teapot", 6}, {"spd:tetra", 6}, {"spd:tree", 11},   {"spd:lattice", 12},
                                                               {"spd:shells", 5}, {"spd:jacks", 1}, {"spd:sombrero", 1}};
  std::vector<std::pair<std::string_view, int>> actual;
  for (const SceneGenerator& generator : scene_generators())
    if (generator.spec_prefix.starts_with("spd:")) actual.emplace_back(generator.spec_prefix, generator.default_size);
  EXPECT_EQ(actual, defaults);
}

struct Grouping {
  const char* spec;
  const char* object;
  std::size_t objects;
  std::int32_t prims_each;
  std::int32_t alone_before, alone_after;
};

TEST(SpdObjects, GroupsAreWhatTheyWereModelledAs) {
  const Grouping groupings[] = {
      {"spd:gears:3", "gear", 27, 146, 1, 0},       {"spd:rings:4", "ring set", 1 + 4 + 9 + 16, 60, 1, 0},
      {"spd:jacks:3", "jack", 1 + 8 + 64, 9, 0, 0}, {"spd:teapot:5", "teapot", 1, 64 * 25 - 8 * 5, 25, 0},
      {"spd:mount:3", "terrain", 1, 2 * 64, 4, 0},
  };
  for (const Grouping& grouping : groupings) {
    SCOPED_TRACE(grouping.spec);
    const Scene scene = generate_scene(grouping.spec);
    ASSERT_EQ(scene.objects().size(), grouping.objects);
    std::int32_t next = grouping.alone_before;
    for (const Object& object : scene.objects()) {
      EXPECT_EQ(object.name, grouping.object);
      EXPECT_EQ(object.first_prim, next);
      EXPECT_EQ(object.end_prim, next + grouping.prims_each);
      next = object.end_prim;
    }
    EXPECT_EQ(next + grouping.alone_after, scene.prim_id_count());
    EXPECT_EQ(scene.object_count(), grouping.alone_before + grouping.alone_after + static_cast<std::int32_t>(grouping.objects));
  }
}

TEST(SpdObjects, FlakesTreesAndLatticesHaveNone) {
  for (const char* const spec : {"spd:balls:2", "spd:tetra:3", "spd:tree:4", "spd:lattice:2", "spd:shells:0", "spd:sombrero:1"})
    EXPECT_TRUE(generate_scene(spec).objects().empty()) << spec;
}

// Watertight meshes: neighbours share corners bit for bit, so each edge is there as often as the surface says.
TEST(SpdGeometry, HeightFieldsShareTheirCorners) {
  for (const auto& [spec, corners] : {std::pair{"spd:mount:5", std::size_t{33 * 33}}, std::pair{"spd:sombrero:1", std::size_t{32 * 32}}}) {
    const Scene scene = generate_scene(spec);
    std::set<std::tuple<float, float, float>> distinct;
    for (const FloatColumns3& vertex : scene.pools().triangles.vertex)
      for (std::size_t i = 0; i < vertex[0].size(); ++i) distinct.emplace(vertex[0][i], vertex[1][i], vertex[2][i]);
    EXPECT_EQ(distinct.size(), corners) << spec;
  }
}

}  // namespace
}  // namespace raymeter
