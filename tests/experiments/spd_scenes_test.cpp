// The generated databases against the output of the original programs (../shared/spd, where it is there), and against samples of it.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

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

/// A primitive as the original programs printed it.
struct Sample {
  const char* spec;
  std::int32_t prim;
  std::array<double, 8> material;  ///< of NFF's entity f
  std::vector<double> lengths;
  std::vector<double> normals;
};

const std::vector<Sample> kSamples{
    {"spd:balls:3", 273, {1, 0.9, 0.7, 0.5, 0.5, 3.0827, 0, 1}, {0.339267, 0.522591, 0.111111, 0.0185185}, {}},
    {"spd:balls:3", 547, {1, 0.9, 0.7, 0.5, 0.5, 3.0827, 0, 1}, {-0.550064, -0.379835, 0.0555556, 0.0185185}, {}},
    {"spd:balls:3", 820, {1, 0.9, 0.7, 0.5, 0.5, 3.0827, 0, 1}, {0.419026, -0.523783, -0.222222, 0.0185185}, {}},
    {"spd:gears:2",
     389,
     {0.211045, 1, 0.802761, 1, 0, 100000, 0, 0},
     {-0.703859, 0.0796652, 1, -0.703859, 0.0796652, 0.9, -0.718037, 0.0321341, 0.9, -0.718037, 0.0321341, 1},
     {}},
    {"spd:gears:2",
     779,
     {0.802761, 1, 1, 0.2, 0, 100000, 0.8, 1.1},
     {0.277645, -0.0759457, 0.5, 0.277645, -0.0759457, 0.4, 0.246843, -0.0370686, 0.4, 0.246843, -0.0370686, 0.5},
     {}},
    {"spd:gears:2",
     1167,
     {1, 1, 1, 1, 0, 100000, 0, 0},
     {0.948437, 0.503287, 0.5, 0.948437, 0.503287, 0.4, 0.996689, 0.514774, 0.4, 0.996689, 0.514774, 0.5},
     {}},
    {"spd:jacks:3", 219, {0.737, 0.561, 0.561, 0.7, 0.7, 11.1434, 0, 1}, {0.197784, -0.146567, -0.753861, 0.0375}, {}},
    {"spd:jacks:3", 438, {0.737, 0.561, 0.561, 0.7, 0.7, 11.1434, 0, 1}, {-0.197784, -0.286446, 1.00386, 0.0375}, {}},
    {"spd:jacks:3", 656, {0.737, 0.561, 0.561, 0.7, 0.7, 11.1434, 0, 1}, {0.512383, 1.04207, 0.30491, 0.0375}, {}},
    {"spd:lattice:6", 408, {0.9, 0.1, 0.1, 0.99, 0, 100000, 0, 0}, {0.353958, 0.166667, 0.666667, 0.479375, 0.166667, 0.666667, 0.0104167, 0.0104167}, {}},
    {"spd:lattice:6", 816, {0.1, 0.1, 0.9, 0.99, 0, 100000, 0, 0}, {0.666667, 0.5, 0.187292, 0.666667, 0.5, 0.312708, 0.0104167, 0.0104167}, {}},
    {"spd:lattice:6", 1224, {0.9, 0.9, 0.9, 0.5, 0.5, 3.0827, 0, 0}, {1, 1, 1, 0.0416667}, {}},
    {"spd:mount:4", 172, {0.5, 0.45, 0.35, 1, 0, 100000, 0, 0}, {0.75, -1, -0.427208, 0.875, -1, -0.13904, 0.875, -0.875, -0.12082}, {}},
    {"spd:mount:4", 344, {0.5, 0.45, 0.35, 1, 0, 100000, 0, 0}, {0.875, 0.875, -0.0438567, 1, 0.875, 0.203188, 1, 1, 0}, {}},
    {"spd:mount:4", 515, {0.5, 0.45, 0.35, 1, 0, 100000, 0, 0}, {-0.875, 1, -0.0309481, -1, 1, 0, -1, 0.875, 0.0897349}, {}},
    {"spd:rings:3", 280, {0, 1, 1, 0.5, 0.2, 3.0827, 0, 0}, {0.712307, 5.62223, 0.208049, 0.07412}, {}},
    {"spd:rings:3", 560, {0, 1, 0, 0.5, 0.2, 3.0827, 0, 0}, {0.465497, 7.68813, -0.791951, 0.07412}, {}},
    {"spd:rings:3", 840, {1, 1, 0, 0.5, 0.2, 3.0827, 0, 0}, {2, 7.34992, 1.20805, 0.07412}, {}},
    {"spd:shells:5", 1920, {1, 0.8, 0.4, 0.8, 0.2, 45.2776, 0, 1}, {0, 0.0591645, -0.118329, 0.0591645}, {}},
    {"spd:shells:5", 3840, {1, 0.8, 0.4, 0.8, 0.2, 45.2776, 0, 1}, {0, 1, -2, 1}, {}},
    {"spd:shells:5", 5760, {1, 0.8, 0.4, 0.8, 0.2, 45.2776, 0, 1}, {0, 16.902, -33.804, 16.902}, {}},
    {"spd:sombrero:1",
     640,
     {1, 0.1, 0.1, 0.8, 0, 2.60078, 0, 1},
     {-1.41935, -2.9133, -1.41935, -1.16129, -2.98098, -1.16129, -1.16129, -2.86435, -1.41935},
     {}},
    {"spd:sombrero:1", 1281, {1, 0.1, 0.1, 0.8, 0, 2.60078, 0, 1}, {1.16129, -3.20865, 1.16129, 1.16129, -3.16263, 1.41935, 1.41935, -2.98098, 1.41935}, {}},
    {"spd:sombrero:1", 1921, {1, 0.1, 0.1, 0.8, 0, 2.60078, 0, 1}, {3.74194, -2.99327, 3.74194, 3.74194, -2.99594, 4, 4, -3.00164, 4}, {}},
    {"spd:teapot:6",
     764,
     {1, 0.5, 0.1, 0.75, 0.25, 3.0827, 0, 0},
     {-1.0163, 1.73037, 0.9, -0.537037, 1.92963, 0.9, -0.527092, 1.8939, 0.693403},
     {-0.501718, 0.865031, 0, -0.260275, 0.965535, 0, -0.244192, 0.905874, -0.346067}},
    {"spd:teapot:6",
     1528,
     {1, 0.5, 0.1, 0.75, 0.25, 3.0827, 0, 0},
     {0.0638032, -0.228728, 2.88333, 0, -0.237037, 2.88333, 0, -0.171296, 2.78542},
     {0.193465, -0.721244, -0.665116, 0, -0.747409, -0.664364, 0, -0.950775, -0.309882}},
    {"spd:teapot:6",
     2291,
     {1, 0.5, 0.1, 0.75, 0.25, 3.0827, 0, 0},
     {1.5, 0, 0.15, 1.44722, -0.402778, 0.15, 1.4355, -0.399515, 0.112847},
     {1, 0, 0, 0.965535, -0.260275, 0, 0.743044, -0.200299, -0.638566}},
    {"spd:tetra:4", 85, {1, 0.2, 0.2, 1, 0, 100000, 0, 0}, {-0.75, 1, -0.75, -0.75, 0.75, -1, -1, 1, -1}, {}},
    {"spd:tetra:4", 170, {1, 0.2, 0.2, 1, 0, 100000, 0, 0}, {1, -1, -1, 1, -0.75, -0.75, 0.75, -1, -0.75}, {}},
    {"spd:tetra:4", 255, {1, 0.2, 0.2, 1, 0, 100000, 0, 0}, {0.75, 1, 0.75, 0.75, 0.75, 1, 1, 1, 1}, {}},
    {"spd:tree:7", 170, {0.55, 0.4, 0.2, 1, 0, 100000, 0, 0}, {0.909185, -0.696718, 2.0957, 0.00909107}, {}},
    {"spd:tree:7", 340, {0.55, 0.4, 0.2, 1, 0, 100000, 0, 0}, {-1.21363, -0.0541, 2.18713, 0.00609102}, {}},
    {"spd:tree:7", 510, {0.55, 0.4, 0.2, 1, 0, 100000, 0, 0}, {-0.299234, 0.515469, 2.99596, 0.00609102}, {}},
};

TEST(SpdSamples, PrimitivesAreThoseOfTheOriginalPrograms) {
  for (const Sample& sample : kSamples) {
    SCOPED_TRACE(std::string(sample.spec) + " primitive " + std::to_string(sample.prim));
    const Scene scene = generate_scene(sample.spec);
    const Shape actual = shape(scene, sample.prim);
    const Material& material = scene.material(sample.prim);
    // As above; the largest scene, shells, is 55 across.
    EXPECT_EQ(first_difference(actual.lengths, sample.lengths, 1e-5, 1e-6), -1);
    EXPECT_EQ(first_difference(actual.normals, sample.normals, 0, 6e-7), -1);
    const std::array<double, 8> numbers{material.color.r,  material.color.g, material.color.b,       material.diffuse,
                                        material.specular, material.shine,   material.transmittance, material.ior};
    for (std::size_t k = 0; k < numbers.size(); ++k) EXPECT_TRUE(same_to_six_digits(numbers[k], sample.material[k])) << "number " << k << " of the material";
  }
}

}  // namespace
}  // namespace raymeter
