#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "core/bounds/aabb.h"
#include "experiments/scenes/generators.h"
#include "experiments/scenes/scene_source.h"
#include "tests/support/mesh_path.h"

namespace raymeter {
namespace {

using Corner = std::array<float, 3>;
using Triangle = std::array<Corner, 3>;

Triangle triangle(const Scene& scene, std::size_t i) {
  Triangle corners{};
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t axis = 0; axis < 3; ++axis) corners[k][axis] = scene.pools().triangles.vertex[k][axis][i];
  return corners;
}

glm::dvec3 point(const Corner& corner) { return {glm::vec3(corner[0], corner[1], corner[2])}; }

double area(const Triangle& t) { return glm::length(glm::cross(point(t[1]) - point(t[0]), point(t[2]) - point(t[0]))) / 2; }

Aabb bounds(const Scene& scene) {
  Aabb box;
  for (std::int32_t prim = 0; prim < scene.prim_id_count(); ++prim) box.grow(tight_bounds(scene.pools(), scene.prim(prim)));
  return box;
}

std::size_t distinct_corners(const Scene& scene) {
  std::vector<Corner> corners;
  for (std::size_t i = 0; i < scene.pools().triangles.size(); ++i)
    for (const Corner& corner : triangle(scene, i)) corners.push_back(corner);
  std::sort(corners.begin(), corners.end());
  return static_cast<std::size_t>(std::unique(corners.begin(), corners.end()) - corners.begin());
}

TEST(Icosphere, IsAClosedSurfaceOfUnitVectorsThatFacesOutwards) {
  for (int subdivisions = 0; subdivisions <= 4; ++subdivisions) {
    const Scene scene = generate_scene("gen:icosphere:" + std::to_string(subdivisions));
    const std::size_t faces = std::size_t{20} << (2 * subdivisions);
    ASSERT_EQ(scene.pools().triangles.size(), faces);
    std::set<std::pair<Corner, Corner>> edges;
    for (std::size_t i = 0; i < faces; ++i) {
      const Triangle t = triangle(scene, i);
      const glm::dvec3 normal = glm::cross(point(t[1]) - point(t[0]), point(t[2]) - point(t[0]));
      ASSERT_GT(glm::dot(normal, point(t[0])), 0);
      for (std::size_t k = 0; k < 3; ++k) {
        ASSERT_NEAR(glm::length(point(t[k])), 1, 1.1e-7);  // sqrt(3) half-units of a float below 1
        ASSERT_TRUE(edges.emplace(t[k], t[(k + 1) % 3]).second) << "an edge is used twice in one direction";
      }
    }
    for (const auto& [from, to] : edges) ASSERT_TRUE(edges.contains({to, from})) << "an edge has one face only";
    EXPECT_EQ(distinct_corners(scene), faces / 2 + 2);  // Euler
  }
}

/// Whatever is split, the same surface comes of it.
TEST(SplitGears, CoverTheFacesThatTheySplit) {
  const auto area_of = [](const Scene& scene) {
    double sum = 0;
    for (std::size_t i = 0; i < scene.pools().size(PrimKind::triangle); ++i) sum += area(triangle(scene, i));
    return sum;
  };
  const Scene whole = load_scene("spd:gears:1"), fans = load_scene("gen:split_gears:1"), ears = load_scene("gen:ear_gears:1"),
              rim = load_scene("gen:rim_gears:1");
  EXPECT_EQ(fans.prim_count(), whole.prim_count() - 2 + 2 * 142);
  EXPECT_EQ(ears.prim_count(), fans.prim_count());
  EXPECT_EQ(rim.prim_count(), whole.prim_count() + 144);
  // 36 teeth and gaps between radii of 0.995 and 0.9: the shoelace formula over the outline, twice.
  double outline = 0;
  const double pitch = std::acos(-1.0) / 18;
  const std::array<std::pair<double, double>, 5> corners{{{0.995, -0.19}, {0.995, 0.19}, {0.9, 0.3}, {0.9, 0.7}, {0.995, 0.81}}};
  for (std::size_t k = 0; k < 4; ++k) {
    outline += 36 * corners[k].first * corners[k + 1].first * std::sin((corners[k + 1].second - corners[k].second) * pitch) / 2;
  }
  EXPECT_NEAR(area_of(fans), 2 * outline, 1e-5);
  EXPECT_NEAR(area_of(ears), 2 * outline, 1e-5);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(bounds(ears).max[i], bounds(whole).max[i]);
}

TEST(Hairball, HasThinStrandsThatShareTheirCorners) {
  const Scene scene = generate_scene("gen:hairball");
  ASSERT_EQ(scene.prim_count(), 288'000);
  EXPECT_EQ(scene.dropped_count(), 0);
  EXPECT_EQ(scene.objects().size(), 2000u);
  EXPECT_EQ(distinct_corners(scene), 150'000u);
  std::vector<double> aspects;
  for (std::size_t i = 0; i < scene.pools().triangles.size(); ++i) {
    const Triangle t = triangle(scene, i);
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k) longest = std::max(longest, glm::distance(point(t[k]), point(t[(k + 1) % 3])));
    aspects.push_back(longest * longest / (2 * area(t)));
  }
  const auto middle = aspects.begin() + 144'000;
  std::nth_element(aspects.begin(), middle, aspects.end());
  EXPECT_GT(*middle, 10);  // what the scene is for
  const Aabb box = bounds(scene);
  for (glm::length_t axis = 0; axis < 3; ++axis) {
    // The reference hairball reaches 1.27 to 1.47.
    EXPECT_GT(box.min[axis], -2);
    EXPECT_LT(box.min[axis], -1);
    EXPECT_GT(box.max[axis], 1);
    EXPECT_LT(box.max[axis], 2);
  }
}

TEST(Stadium, HasItsTeapotAndItsParts) {
  const Scene scene = generate_scene("gen:stadium");
  EXPECT_EQ(scene.prim_count(), 20'900);
  EXPECT_EQ(scene.dropped_count(), 0);
  const Aabb box = bounds(scene);
  EXPECT_EQ(box.min, glm::vec3(-200, -200, -0.05f));
  EXPECT_EQ(box.max, glm::vec3(200, 200, 45));
  std::map<std::string, std::pair<int, int>> parts;  // objects, triangles
  for (const Object& object : scene.objects()) {
    ++parts[object.name].first;
    parts[object.name].second += object.end_prim - object.first_prim;
  }
  const std::map<std::string, std::pair<int, int>> expected{{"bowl", {1, 11'712}}, {"pylon", {8, 64}}, {"teapot", {1, 9120}}};
  EXPECT_EQ(parts, expected);
}

TEST(Stadium, IsTheReferenceMesh) {
  const std::string path = test::mesh_path("teapot_stadium");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const Scene file = load_scene(path), made = generate_scene("gen:stadium");
  ASSERT_EQ(made.prim_count(), file.prim_count());
  for (std::size_t i = 0; i < file.pools().triangles.size(); ++i) {
    const Triangle expected = triangle(file, i), actual = triangle(made, i);
    for (std::size_t k = 0; k < 3; ++k) {
      // The file was rounded to 1e-4, the teapot after it had been rounded to 6 digits, all to float.
      ASSERT_LE(glm::distance(point(actual[k]), point(expected[k])), std::sqrt(3.0) * (5e-5 + 1e-6) + 1e-5 * (i < 11'780 ? 1 : 0)) << "triangle " << i;
    }
  }
}

TEST(Terrain, HasTheNearestNumberOfTrianglesOnAGrid) {
  for (const auto& [size, cells] : {std::pair{2, 1}, {3, 1}, {8, 2}, {9, 2}, {1000, 22}, {20'000, 100}, {100'000, 224}}) {
    const Scene scene = generate_scene("gen:terrain:" + std::to_string(size));
    EXPECT_EQ(scene.prim_count(), 2 * cells * cells) << size;
    EXPECT_EQ(distinct_corners(scene), static_cast<std::size_t>((cells + 1) * (cells + 1))) << size;
    const Aabb box = bounds(scene);
    EXPECT_EQ(glm::vec2(box.min), glm::vec2(-1)) << size;
    EXPECT_EQ(glm::vec2(box.max), glm::vec2(1)) << size;
    ASSERT_EQ(scene.objects().size(), 1u);
  }
}

TEST(Terrain, FacesUpwardsAndIsRough) {
  const Scene scene = generate_scene("gen:terrain:20000");
  double surface = 0;
  for (std::size_t i = 0; i < scene.pools().triangles.size(); ++i) {
    const Triangle t = triangle(scene, i);
    ASSERT_GT(glm::cross(point(t[1]) - point(t[0]), point(t[2]) - point(t[0])).z, 0) << i;
    surface += area(t);
  }
  EXPECT_GT(surface, 1.1 * 4);  // the square below it has area 4
}

TEST(Terrain, ShowsTheSameMountainsAtEverySize) {
  // Octaves below the coarser grid's cells are missing there: their amplitudes 0.25 * 2^(-0.8 k), from k = 4 on, add up to less than this.
  constexpr double kMissing = 0.25 * 0.1089 / (1 - 0.5744);
  const Scene coarse = generate_scene("gen:terrain:9522"), fine = generate_scene("gen:terrain:152352");  // 69^2 and 276^2 cells
  std::map<std::pair<float, float>, float> heights;
  for (std::size_t i = 0; i < fine.pools().triangles.size(); ++i)
    for (const Corner& corner : triangle(fine, i)) heights[{corner[0], corner[1]}] = corner[2];
  for (std::size_t i = 0; i < coarse.pools().triangles.size(); ++i) {
    for (const Corner& corner : triangle(coarse, i)) {
      const auto found = heights.find({corner[0], corner[1]});
      ASSERT_NE(found, heights.end());
      ASSERT_NEAR(corner[2], found->second, kMissing);
    }
  }
}

TEST(Clouds, StayInTheUnitCubeAndLetARayMeetOneInTheMean) {
  for (const int size : {1000, 100'000}) {
    const Scene triangles = generate_scene("gen:cloud:" + std::to_string(size));
    const Scene spheres = generate_scene("gen:spheres:" + std::to_string(size));
    for (const Scene* const scene : {&triangles, &spheres}) {
      ASSERT_EQ(scene->prim_count(), size);
      const Aabb box = bounds(*scene);
      EXPECT_TRUE(glm::all(glm::greaterThanEqual(box.min, glm::vec3(-1e-6f)))) << scene->name;  // a float of a corner near a face of the cube
      EXPECT_TRUE(glm::all(glm::lessThanEqual(box.max, glm::vec3(1 + 1e-6f)))) << scene->name;
      EXPECT_TRUE(glm::all(glm::greaterThan(box.extent(), glm::vec3(0.9f)))) << scene->name;
    }
    // A line in a random direction meets a flat piece of area A with probability A / 2 a unit of cross section, a sphere with pi r^2. Floats of corners near 1
    // are off by 3e-8, an edge here is at least 6e-3 long.
    double hits = 0;
    for (std::size_t i = 0; i < triangles.pools().triangles.size(); ++i) hits += area(triangle(triangles, i)) / 2;
    EXPECT_NEAR(hits, 1, 1e-4);
    const auto radius = static_cast<double>(spheres.pools().spheres.radius[0]);
    EXPECT_NEAR(size * 3.14159265358979 * radius * radius, 1, 1e-6);
  }
}

TEST(Clouds, TakeFewBytesATriangle) {
  constexpr int kTriangles = 1'000'000;
  const Scene scene = generate_scene("gen:cloud:" + std::to_string(kTriangles));
  // Nine floats, the primitive's id, and its place in the pool; the columns' padding is 64 elements each.
  const std::size_t columns = 11;
  EXPECT_LE(scene.mem_bytes(), (9 * 4 + 4 + 4) * std::size_t{kTriangles} + columns * 64 * 4 + 4096);
}

TEST(GenScenes, AreTheSameEveryTimeAndDifferFromOneAnother) {
  std::set<std::uint64_t> hashes;
  int scenes = 0;
  for (const SceneGenerator& generator : scene_generators()) {
    if (!generator.spec_prefix.starts_with("gen:")) continue;
    const int size = generator.min_size + 2;
    const std::uint64_t hash = generator.make(size).hash();
    EXPECT_EQ(hash, generator.make(size).hash()) << generator.spec_prefix;
    hashes.insert(hash);
    ++scenes;
  }
  EXPECT_EQ(hashes.size(), static_cast<std::size_t>(scenes));
}

TEST(Generators, GiveEverySceneAViewLightsAndAMaterial) {
  for (const SceneGenerator& generator : scene_generators()) {
    const Scene scene = generator.make(std::max(generator.min_size, 1));
    EXPECT_GT(scene.prim_count(), 0) << generator.spec_prefix;
    EXPECT_EQ(scene.dropped_count(), 0) << generator.spec_prefix;
    EXPECT_FALSE(scene.lights.empty()) << generator.spec_prefix;
    EXPECT_FALSE(scene.camera == Camera{}) << generator.spec_prefix;
    ASSERT_FALSE(scene.material_runs().empty()) << generator.spec_prefix;
    EXPECT_EQ(scene.material_runs()[0].first_prim, 0) << generator.spec_prefix;
    EXPECT_TRUE(generator.min_size <= generator.default_size && generator.default_size <= generator.max_size) << generator.spec_prefix;
    EXPECT_FALSE(generator.summary.empty() || generator.size_means.empty()) << generator.spec_prefix;
  }
}

}  // namespace
}  // namespace raymeter
