// The generated databases against the output of the original programs (../shared/spd, where it is there) and against the published counts and extents.

#include <cmath>
#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <glm/common.hpp>

#include "core/bounds/aabb.h"
#include "experiments/scenes/generators.h"
#include "experiments/scenes/scene_source.h"

namespace raymeter {
namespace {

/// All numbers of a primitive: lengths, which scale with the scene, and components of unit vectors.
struct Shape {
  PrimKind kind;
  std::vector<double> lengths;
  std::vector<double> normals;
};

void append(std::vector<double>& numbers, const FloatColumns3& columns, std::size_t i) {
  for (const Column<float>& column : columns) numbers.push_back(static_cast<double>(column[i]));
}

Shape shape(const Scene& scene, std::int32_t prim) {
  const PrimRef ref = scene.prim(prim);
  const std::size_t i = ref.index;
  Shape shape{ref.kind(), {}, {}};
  switch (shape.kind) {
    case PrimKind::sphere:
      append(shape.lengths, scene.pools().spheres.center, i);
      shape.lengths.push_back(static_cast<double>(scene.pools().spheres.radius[i]));
      break;
    case PrimKind::triangle: {
      const TrianglePool& pool = scene.pools().triangles;
      for (const FloatColumns3& vertex : pool.vertex) append(shape.lengths, vertex, i);
      if (!pool.normal_index.empty() && pool.normal_index[i] >= 0)
        for (const FloatColumns3& normal : pool.normal) append(shape.normals, normal, static_cast<std::size_t>(pool.normal_index[i]));
      break;
    }
    case PrimKind::polygon: {
      const PolygonPool& pool = scene.pools().polygons;
      for (auto v = pool.first_vertex[i]; v < pool.first_vertex[i + 1]; ++v) append(shape.lengths, pool.vertex, static_cast<std::size_t>(v));
      break;
    }
    case PrimKind::cone: {
      const ConePool& pool = scene.pools().cones;
      append(shape.lengths, pool.base, i);
      append(shape.lengths, pool.axis, i);
      for (std::size_t a = 0; a < 3; ++a) shape.lengths[3 + a] += shape.lengths[a];
      for (const Column<float>& radius : pool.radius) shape.lengths.push_back(static_cast<double>(radius[i]));
      break;
    }
  }
  return shape;
}

Aabb bounds(const Scene& scene) {
  Aabb box;
  for (std::int32_t prim = 0; prim < scene.prim_id_count(); ++prim) box.grow(tight_bounds(scene.pools(), scene.prim(prim)));
  return box;
}

/// Half a unit of the sixth digit, which is what the files keep.
constexpr double kSixDigits = 5e-6;
bool same_to_six_digits(double value, double printed) { return std::abs(value - printed) <= kSixDigits * std::abs(printed) * (1 + 1e-9); }
bool same_to_six_digits(const glm::dvec3& value, const glm::dvec3& printed) {
  return same_to_six_digits(value.x, printed.x) && same_to_six_digits(value.y, printed.y) && same_to_six_digits(value.z, printed.z);
}

/// The first difference of two lists of numbers that exceeds both tolerances, or -1.
std::ptrdiff_t first_difference(const std::vector<double>& made, const std::vector<double>& file, double relative, double absolute) {
  if (made.size() != file.size()) return 0;
  for (std::size_t k = 0; k < made.size(); ++k) {
    const double error = std::abs(made[k] - file[k]);
    if (!(error <= absolute || error <= relative * std::abs(file[k]))) return static_cast<std::ptrdiff_t>(k);
  }
  return -1;
}

struct SpdFile {
  std::string name;
  int size;
  friend std::ostream& operator<<(std::ostream& out, const SpdFile& file) { return out << file.name << " " << file.size; }
};

class SpdFiles : public testing::TestWithParam<SpdFile> {
protected:
  void SetUp() override {
    const std::string path = "../shared/spd/" + GetParam().name + "-s" + std::to_string(GetParam().size) + ".nff.xz";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
    file = load_scene(path);
    made = generate_scene("spd:" + GetParam().name + ":" + std::to_string(GetParam().size));
  }
  Scene file, made;
};

TEST_P(SpdFiles, HaveTheSamePrimitivesInTheSameOrder) {
  ASSERT_EQ(made.prim_id_count(), file.prim_id_count());
  ASSERT_EQ(made.dropped_count(), 0);
  const glm::vec3 extent = bounds(file).extent();
  const double scene_size = static_cast<double>(std::max({extent.x, extent.y, extent.z}));
  for (std::int32_t prim = 0; prim < file.prim_id_count(); ++prim) {
    const Shape expected = shape(file, prim), actual = shape(made, prim);
    ASSERT_EQ(actual.kind, expected.kind) << "primitive " << prim;
    // The files carry 6 digits: 5e-6 of a coordinate, and the float of it.
    ASSERT_EQ(first_difference(actual.lengths, expected.lengths, 1e-5, 1e-6 * scene_size), -1) << "primitive " << prim;
    // Half a unit of the sixth digit of a number below 1, and the float of it.
    ASSERT_EQ(first_difference(actual.normals, expected.normals, 0, 6e-7), -1) << "primitive " << prim;
  }
}

TEST_P(SpdFiles, HaveTheSameMaterials) {
  ASSERT_EQ(made.prim_id_count(), file.prim_id_count());
  for (std::int32_t prim = 0; prim < file.prim_id_count(); ++prim) {
    const Material &expected = file.material(prim), &actual = made.material(prim);
    ASSERT_TRUE(same_to_six_digits(actual.color, expected.color)) << "primitive " << prim;
    ASSERT_EQ(actual.diffuse, expected.diffuse) << "primitive " << prim;
    ASSERT_EQ(actual.specular, expected.specular) << "primitive " << prim;
    ASSERT_TRUE(same_to_six_digits(actual.shine, expected.shine)) << "primitive " << prim << ": " << actual.shine << ", " << expected.shine;
    ASSERT_EQ(actual.transmittance, expected.transmittance) << "primitive " << prim;
    ASSERT_EQ(actual.ior, expected.ior) << "primitive " << prim;
  }
}

TEST_P(SpdFiles, HaveTheSameLightsAndView) {
  EXPECT_EQ(made.background, file.background);
  ASSERT_EQ(made.lights.size(), file.lights.size());
  for (std::size_t i = 0; i < file.lights.size(); ++i) {
    EXPECT_TRUE(same_to_six_digits(made.lights[i].position, file.lights[i].position)) << "light " << i;
    EXPECT_EQ(made.lights[i].color, file.lights[i].color) << "light " << i;
  }
  EXPECT_TRUE(same_to_six_digits(made.camera.eye, file.camera.eye));
  EXPECT_TRUE(same_to_six_digits(made.camera.look_at, file.camera.look_at));
  EXPECT_TRUE(same_to_six_digits(made.camera.up, file.camera.up));
  EXPECT_EQ(made.camera.fov_degrees, file.camera.fov_degrees);
  EXPECT_EQ(made.camera.hither, file.camera.hither);
  EXPECT_EQ(made.camera.width, file.camera.width);
  EXPECT_EQ(made.camera.height, file.camera.height);
}

INSTANTIATE_TEST_SUITE_P(Spd, SpdFiles,
                         testing::ValuesIn(std::vector<SpdFile>{{"balls", 2}, {"balls", 3},   {"balls", 4},    {"gears", 2},  {"gears", 4},   {"jacks", 1},
                                                                {"jacks", 3}, {"lattice", 6}, {"lattice", 12}, {"mount", 4},  {"mount", 6},   {"rings", 3},
                                                                {"rings", 7}, {"shells", 5},  {"sombrero", 1}, {"teapot", 6}, {"teapot", 12}, {"tetra", 4},
                                                                {"tetra", 6}, {"tree", 7},    {"tree", 11}}),
                         [](const auto& file) { return file.param.name + std::to_string(file.param.size); });

}  // namespace
}  // namespace raymeter
