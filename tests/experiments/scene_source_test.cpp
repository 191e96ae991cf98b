#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/bounds/aabb.h"
#include "experiments/scenes/scene_source.h"
#include "tests/support/expect_error.h"
#include "tests/support/mesh_path.h"

namespace raymeter {
namespace {

void expect_error(const std::string& spec, const std::string& message) {
  expect_error_message([&] { (void)load_scene(spec); }, message);
}

/// A file in the temporary folder that goes with the test.
class TempFile {
public:
  TempFile(const std::string& name, const std::string& bytes) : path_(std::filesystem::path(testing::TempDir()) / ("raymeter_scene_source_" + name)) {
    std::ofstream(path_, std::ios::binary) << bytes;
  }
  TempFile(const TempFile&) = delete;
  TempFile& operator=(const TempFile&) = delete;
  ~TempFile() { std::filesystem::remove(path_); }
  [[nodiscard]] std::string path() const { return path_.string(); }

private:
  std::filesystem::path path_;
};

struct Expected {
  const char* file;
  std::size_t prims, spheres, cones, polygons, triangles, triangles_with_normals, lights;
  glm::vec3 box_min, box_max;
};

/// Counts and bounding boxes of the databases, by an independent reader; polygons have more than 3 vertices.
constexpr std::array kDatabases{
    Expected{"balls-s2", 92, 91, 0, 1, 0, 0, 3, {-12, -12, -0.5}, {12, 12, 0.785072}},
    Expected{"balls-s3", 821, 820, 0, 1, 0, 0, 3, {-12, -12, -0.5}, {12, 12, 0.821994}},
    Expected{"balls-s4", 7382, 7381, 0, 1, 0, 0, 3, {-12, -12, -0.5}, {12, 12, 0.830567}},
    Expected{"gears-s2", 1169, 0, 0, 1169, 0, 0, 5, {-2, -2, 0}, {2, 2, 1}},
    Expected{"gears-s4", 9345, 0, 0, 9345, 0, 0, 5, {-2, -2, 0}, {2, 2, 1}},
    Expected{"jacks-s1", 9, 6, 3, 0, 0, 0, 1, {-0.854769, -0.799519, -0.760348}, {0.854769, 0.799519, 0.760348}},
    Expected{"jacks-s3", 657, 438, 219, 0, 0, 0, 1, {-1.17498, -1.33004, -1.39758}, {1.17498, 1.33004, 1.39758}},
    Expected{"lattice-s12", 8281, 2197, 6084, 0, 0, 0, 6, {-0.0208333, -0.0208333, -0.0208333}, {1.02083, 1.02083, 1.02083}},
    Expected{"lattice-s6", 1225, 343, 882, 0, 0, 0, 6, {-0.0416667, -0.0416667, -0.0416667}, {1.04167, 1.04167, 1.04167}},
    Expected{"mount-s4", 516, 4, 0, 0, 512, 0, 1, {-1.15961, -1, -0.702953}, {1, 1.15961, 1.37821}},
    Expected{"mount-s6", 8196, 4, 0, 0, 8192, 0, 1, {-1.15961, -1, -0.702953}, {1, 1.15961, 1.37821}},
    Expected{"nurbtst-s1", 1500, 0, 0, 0, 1500, 1500, 1, {-2.98205, -1.33171, -3.16506}, {2.98205, 2.3328, 3.16506}},
    Expected{"rings-s3", 841, 420, 420, 1, 0, 0, 3, {-6.46608, 1.65358, -4.96608}, {4.46608, 10.4525, 5.96608}},
    Expected{"rings-s7", 8401, 4200, 4200, 1, 0, 0, 3, {-10.8389, 1.65358, -9.33895}, {8.83895, 20.905, 10.3389}},
    Expected{"sample-s1", 881, 0, 1, 0, 880, 864, 1, {-4, -2, -4}, {4, 2, 4}},
    Expected{"shells-s5", 5761, 5761, 0, 0, 0, 0, 1, {-27.3134, -21.5798, -50.706}, {17.0498, 33.804, -0.00350044}},
    Expected{"sombrero-s1", 1922, 0, 0, 0, 1922, 0, 1, {-4, -3.60653, -4}, {4, -2, 4}},
    Expected{"teapot-s12", 9264, 0, 0, 144, 9120, 9120, 2, {-4, -4, 0}, {4, 4, 3.15}},
    Expected{"teapot-s6", 2292, 0, 0, 36, 2256, 2256, 2, {-4, -4, 0}, {4, 4, 3.15}},
    Expected{"tetra-s4", 256, 0, 0, 0, 256, 0, 1, {-1, -1, -1}, {1, 1, 1}},
    Expected{"tetra-s6", 4096, 0, 0, 0, 4096, 0, 1, {-1, -1, -1}, {1, 1, 1}},
    Expected{"tree-s11", 8191, 4095, 4095, 1, 0, 0, 7, {-50, -50, 0}, {50, 50, 3.13749}},
    Expected{"tree-s7", 511, 255, 255, 1, 0, 0, 7, {-50, -50, 0}, {50, 50, 3.00205}},
};

Aabb scene_bounds(const Scene& scene) {
  Aabb box;
  for (std::int32_t id = 0; id < scene.prim_id_count(); ++id) box.grow(tight_bounds(scene.pools(), scene.prim(id)));
  return box;
}

TEST(SceneSource, LoadsEveryProceduralDatabase) {
  if (!std::filesystem::exists("../shared/spd")) GTEST_SKIP() << "../shared/spd is not here";
  for (const Expected& expected : kDatabases) {
    SCOPED_TRACE(expected.file);
    const std::string spec = std::string("../shared/spd/") + expected.file + ".nff.xz";
    const Scene scene = load_scene(spec);
    EXPECT_EQ(scene.name, spec);
    const Pools& pools = scene.pools();
    EXPECT_EQ(scene.dropped_count(), 0);
    EXPECT_EQ(static_cast<std::size_t>(scene.prim_count()), expected.prims);
    EXPECT_EQ(pools.spheres.size(), expected.spheres);
    EXPECT_EQ(pools.cones.size(), expected.cones);
    EXPECT_EQ(pools.polygons.size(), expected.polygons);
    EXPECT_EQ(pools.triangles.size(), expected.triangles);
    EXPECT_EQ(pools.triangles.normal[0][0].size(), expected.triangles_with_normals);
    EXPECT_EQ(scene.lights.size(), expected.lights);
    const Aabb box = scene_bounds(scene);
    for (glm::length_t axis = 0; axis < 3; ++axis) {
      // The file's and the table's 6 digits: half a unit of the sixth digit each.
      EXPECT_NEAR(box.min[axis], expected.box_min[axis], 1e-5 * std::max(1.0f, std::abs(expected.box_min[axis])));
      EXPECT_NEAR(box.max[axis], expected.box_max[axis], 1e-5 * std::max(1.0f, std::abs(expected.box_max[axis])));
    }
  }
}

TEST(SceneSource, LoadsEveryMesh) {
  constexpr std::array<std::pair<const char*, std::size_t>, 11> kTriangles{{{"armadillo", 52000},
                                                                            {"bunny", 69451},
                                                                            {"dragon", 871414},
                                                                            {"dragon_res2", 202520},
                                                                            {"forest", 422402},
                                                                            {"hairball", 288000},
                                                                            {"kitchen", 1021813},
                                                                            {"pine", 1650},
                                                                            {"spaceship", 257480},
                                                                            {"spot", 5856},
                                                                            {"teapot_stadium", 20900}}};
  std::string missing;
  for (const auto& [name, triangles] : kTriangles) {
    const std::string path = test::mesh_path(name);
    if (!std::filesystem::exists(path)) {
      missing += path + " ";
      continue;
    }
    const Scene scene = load_scene(path);
    EXPECT_EQ(scene.pools().triangles.size(), triangles) << name;
    EXPECT_EQ(static_cast<std::size_t>(scene.prim_count()), triangles) << name;
    EXPECT_EQ(scene.dropped_count(), 0) << name;
  }
  if (!missing.empty()) GTEST_SKIP() << missing << "is not here";
}

TEST(SceneSource, ReadsGzipAndUpperCaseEndings) {
  // gzip of "s 0 0 0 1\n", without a time stamp.
  const std::string gzip("\x1f\x8b\x08\x00\x00\x00\x00\x00\x02\xff\x2b\x56\x30\x00\x43\x43\x2e\x00\xeb\xc6\x20\x1d\x0a\x00\x00\x00", 26);
  EXPECT_EQ(load_scene(TempFile("sphere.nff.gz", gzip).path()).prim_count(), 1);
  EXPECT_EQ(load_scene(TempFile("SPHERE.NFF", "s 0 0 0 1").path()).prim_count(), 1);
  const TempFile truncated("truncated.nff.gz", gzip.substr(0, 15));
  expect_error(truncated.path(), truncated.path() + ": cannot be decompressed: truncated gzip input");
  const TempFile plain("plain.nff.xz", "s 0 0 0 1");
  expect_error(plain.path(), plain.path() + ": is not compressed as its name says; expected xz or gzip data");
}

TEST(SceneSource, PassesGeneratorsOn) {
  EXPECT_EQ(load_scene("spd:balls:1").prim_count(), 11);
  EXPECT_EQ(load_scene("spd:balls:1").name, "spd:balls:1");
  EXPECT_THROW((void)load_scene("spd:bowls"), Error);
  EXPECT_THROW((void)load_scene("gen:"), Error);
}

TEST(SceneSource, SaysWhatIsNotThere) {
  expect_error("no/such/file.nff", "no/such/file.nff: no such file");
  const TempFile other("scene.txt", "");
  expect_error(other.path(), other.path() +
                                 ": unknown kind of scene; expected a file that ends in one of .glb .gltf .nff .obj .ply .stl (.xz or .gz may follow), or "
                                 "spd:NAME, gen:NAME or hard:NAME");
  const std::string folder = testing::TempDir() + "raymeter_folder.nff";
  std::filesystem::create_directory(folder);
  expect_error(folder, folder + ": is not a regular file");
  std::filesystem::remove(folder);
}

}  // namespace
}  // namespace raymeter
