#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <numbers>

#include <nlohmann/json.hpp>

#include "experiments/scenes/scene_readers.h"
#include "tests/support/expect_error.h"

namespace raymeter {
namespace {

using Json = nlohmann::json;

template <class T, std::size_t N>
std::string bytes_of(const std::array<T, N>& values) {
  return {reinterpret_cast<const char*>(values.data()), sizeof values};
}

const std::string kSquare = bytes_of(std::array<float, 12>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
const std::string kNormals = bytes_of(std::array<float, 12>{0, 0, 1, 0, 1, 1, 0, 0, 1, 0, 0, 1});

/// A document with one node and one primitive, whose positions are kSquare and whose indices are what follows it in the buffer.
Json document(const std::string& buffer, std::int64_t index_type, std::int64_t index_count, int mode) {
  return {{"asset", {{"version", "2.0"}}},
          {"scenes", {{{"nodes", {0}}}}},
          {"nodes", {{{"mesh", 0}, {"name", "square"}}}},
          {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}, {"mode", mode}}}}}}},
          {"accessors",
           {{{"bufferView", 0}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}},
            {{"bufferView", 1}, {"componentType", index_type}, {"count", index_count}, {"type", "SCALAR"}}}},
          {"bufferViews", {{{"buffer", 0}, {"byteLength", 48}}, {{"buffer", 0}, {"byteOffset", 48}, {"byteLength", buffer.size() - 48}}}},
          {"buffers", {{{"byteLength", buffer.size()}}}}};
}

std::string word(std::size_t value) { return bytes_of(std::array{static_cast<std::uint32_t>(value)}); }

std::string glb(const Json& json, std::string buffer) {
  std::string text = json.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  buffer.resize((buffer.size() + 3) / 4 * 4);
  const std::string chunks = word(text.size()) + "JSON" + text + word(buffer.size()) + std::string("BIN\0", 4) + buffer;
  return "glTF" + word(2) + word(12 + chunks.size()) + chunks;
}

Scene read(const std::string& bytes) { return read_gltf({"test.glb", bytes, std::nullopt}); }
void expect_error(const std::string& bytes, const std::string& message) {
  expect_error_message([&] { (void)read(bytes); }, "test.glb: " + message);
}

/// The vertices of a triangle as digits: x + 2 y + 4 z of each corner.
std::string corners(const Scene& scene, std::size_t triangle) {
  std::string text;
  for (const FloatColumns3& vertex : scene.pools().triangles.vertex) {
    text += std::to_string(static_cast<int>(vertex[0][triangle] + 2 * vertex[1][triangle] + 4 * vertex[2][triangle]));
  }
  return text;
}

TEST(GltfReader, ReadsTrianglesStripsAndFansOfEveryIndexType) {
  const std::string triangles = kSquare + bytes_of(std::array<std::uint16_t, 6>{0, 1, 2, 0, 2, 3});
  const Scene list = read(glb(document(triangles, 5123, 6, 4), triangles));
  ASSERT_EQ(list.prim_count(), 2);
  EXPECT_EQ(corners(list, 0) + " " + corners(list, 1), "013 032");
  const std::string bytes = kSquare + bytes_of(std::array<std::uint8_t, 4>{0, 1, 3, 2});
  const Scene strip = read(glb(document(bytes, 5121, 4, 5), bytes));
  ASSERT_EQ(strip.prim_count(), 2);
  EXPECT_EQ(corners(strip, 0) + " " + corners(strip, 1), "012 132");
  const std::string words = kSquare + bytes_of(std::array<std::uint32_t, 4>{0, 1, 2, 3});
  const Scene fan = read(glb(document(words, 5125, 4, 6), words));
  ASSERT_EQ(fan.prim_count(), 2);
  EXPECT_EQ(corners(fan, 0) + " " + corners(fan, 1), "130 320");
  EXPECT_EQ(read(glb(document(words, 5125, 4, 1), words)).prim_count(), 0);  // lines
}

TEST(GltfReader, PlacesNodesInTheWorldAsObjects) {
  const std::string buffer = kSquare + bytes_of(std::array<std::uint8_t, 3>{0, 1, 2});
  Json json = document(buffer, 5121, 3, 4);
  const double half_turn[4] = {0, 0, 1, 0};  // about z
  json["nodes"] = {{{"translation", {10, 20, 30}}, {"scale", {2, 2, 2}}, {"children", {2, 1}}, {"mesh", 0}, {"name", "parent"}},
                   {{"rotation", half_turn}, {"mesh", 0}},
                   {{"matrix", {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 5, 0, 1}}, {"mesh", 0}},
                   {{"mesh", 0}, {"name", "not shown"}}};
  const Scene scene = read(glb(json, buffer));
  ASSERT_EQ(scene.objects().size(), 3u);
  EXPECT_EQ(scene.objects()[0].name, "parent");
  EXPECT_EQ(scene.objects()[1].name, "mesh 0");
  EXPECT_EQ(scene.objects()[0].to_world[3], glm::dvec4(10, 20, 30, 1));
  const auto vertex = [&](std::size_t triangle, std::size_t k) {
    const FloatColumns3& columns = scene.pools().triangles.vertex[k];
    return glm::vec3(columns[0][triangle], columns[1][triangle], columns[2][triangle]);
  };
  EXPECT_EQ(vertex(0, 2), glm::vec3(12, 22, 30));
  EXPECT_EQ(vertex(1, 0), glm::vec3(10, 30, 30));
  EXPECT_EQ(vertex(1, 1), glm::vec3(8, 32, 30));  // mirrored: corners 1 and 2 change places
  EXPECT_EQ(vertex(1, 2), glm::vec3(8, 30, 30));
  EXPECT_EQ(vertex(2, 2), glm::vec3(8, 18, 30));
  json.erase("scenes");
  EXPECT_EQ(read(glb(json, buffer)).prim_count(), 4);
  EXPECT_EQ(read(glb(json, buffer)).objects()[3].name, "not shown");
}

TEST(GltfReader, ReadsNormalsMaterialAndCamera) {
  const std::string buffer = kSquare + kNormals;
  Json json = document(buffer, 5126, 4, 4);
  json["accessors"][1]["type"] = "VEC3";
  json["meshes"][0]["primitives"][0] = {{"attributes", {{"POSITION", 0}, {"NORMAL", 1}}}, {"mode", 5}, {"material", 0}};
  json["materials"] = {{{"alphaMode", "BLEND"}, {"pbrMetallicRoughness", {{"baseColorFactor", {1, 0.5, 0.25, 0.75}}}}}};
  json["nodes"].push_back({{"camera", 0}, {"translation", {0, 0, 5}}});
  json["scenes"][0]["nodes"] = {0, 1};
  json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", std::numbers::pi / 3}, {"znear", 0.5}}}}};
  const Scene scene = read(glb(json, buffer));
  EXPECT_EQ(scene.material(0), (Material{{1, 0.5, 0.25}, 1, 0, 0, 0.25, 1}));
  EXPECT_EQ(scene.pools().triangles.normal[1][1][0], 1.0f);
  EXPECT_EQ(scene.camera.eye, glm::dvec3(0, 0, 5));
  EXPECT_EQ(scene.camera.look_at, glm::dvec3(0, 0, 4));
  EXPECT_DOUBLE_EQ(scene.camera.fov_degrees, 60);
  EXPECT_EQ(scene.camera.hither, 0.5);
  EXPECT_EQ(scene.lights.size(), 1u);
}

TEST(GltfReader, ReadsDataUrisAndFilesBesideIt) {
  const std::string buffer = kSquare + bytes_of(std::array<std::uint8_t, 3>{0, 1, 2});
  Json json = document(buffer, 5121, 3, 4);
  json["buffers"][0]["uri"] = "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAACAPwAAgD8AAAAAAAAAAAAAgD8AAAAAAAEC";
  EXPECT_EQ(corners(read(json.dump()), 0), "013");
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "raymeter_gltf_reader";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "a buffer.bin", std::ios::binary) << buffer;
  json["buffers"][0]["uri"] = "a%20buffer.bin";
  const Scene scene = read_gltf({"test.gltf", json.dump(), folder});
  std::filesystem::remove_all(folder);
  EXPECT_EQ(corners(scene, 0), "013");
}

TEST(GltfReader, LetsTheSceneDropWhatIsNotFinite) {
  std::string buffer = kSquare + bytes_of(std::array<std::uint8_t, 6>{0, 1, 2, 0, 2, 3});
  const float infinite = std::numeric_limits<float>::infinity();
  std::memcpy(buffer.data() + 12, &infinite, 4);
  EXPECT_EQ(read(glb(document(buffer, 5121, 6, 4), buffer)).dropped_count(), 1);
}

TEST(GltfReader, TakesADocumentWithoutNodesAsAnEmptyScene) { EXPECT_EQ(read(R"({"asset": {"version": "2.0"}})").prim_count(), 0); }

TEST(GltfReader, SurvivesDeepNesting) {
  const std::string deep(200000, '[');
  expect_error(deep, "is no valid JSON at byte 200001 of its text; expected glTF");
  EXPECT_EQ(read(R"({"asset": {"version": "2.0"}, "extras": )" + deep + std::string(deep.size(), ']') + "}").prim_count(), 0);
}

TEST(GltfReader, SaysWhatIsWrongWithTheFile) {
  expect_error("", "is no valid JSON at byte 1 of its text; expected glTF");
  expect_error("garbage", "is no valid JSON at byte 1 of its text; expected glTF");
  expect_error("[1e999]", "is no valid JSON: a number is out of range; expected glTF");
  expect_error("[]", "expected an object");
  expect_error("{}", "'asset' is missing");
  expect_error(R"({"asset": {"version": "1.0"}})", "asset.version: expected glTF version 2");
  expect_error(R"({"asset": {"version": "2.0"}, "extensionsRequired": ["KHR_draco_mesh_compression"]})",
               "extensionsRequired[0]: this extension is not supported");
  const std::string buffer = kSquare + bytes_of(std::array<std::uint8_t, 3>{0, 1, 2});
  const std::string whole = glb(document(buffer, 5121, 3, 4), buffer);
  expect_error(whole.substr(0, 15), "binary glTF ends after 15 bytes, within its headers");
  expect_error(whole.substr(0, whole.size() - 4),
               "binary glTF states " + std::to_string(whole.size()) + " bytes, but the file has " + std::to_string(whole.size() - 4));
  expect_error("glTF" + word(1) + word(20) + "12345678", "binary glTF version 1; expected 2");
  expect_error("glTF" + word(2) + word(20) + word(5) + "JSON", "byte 12: binary glTF ends within a chunk");
  expect_error("glTF" + word(2) + word(20) + word(0) + "TEXT", "byte 12: expected one chunk of JSON, before all others");
}

TEST(GltfReader, NamesThePathAndTheExpectationOfWhatIsWrongInTheDocument) {
  const std::string buffer = kSquare + bytes_of(std::array<std::uint8_t, 3>{0, 1, 2});
  const Json good = document(buffer, 5121, 3, 4);
  const auto expect_wrong = [&](const std::string& pointer, const Json& value, const std::string& message) {
    SCOPED_TRACE(pointer);
    Json json = good;
    json[Json::json_pointer(pointer)] = value;
    expect_error(glb(json, buffer), message);
  };
  expect_error(glb(good, buffer.substr(0, 50) + '\x04'), "meshes[0].primitives[0]: indices[2] is 4; expected less than the 4 vertices");
  expect_wrong("/nodes/0/mesh", 1, "meshes: has 1 elements, none of index 1");
  expect_wrong("/nodes/0/mesh", "a", "nodes[0].mesh: expected an integer from 0 to 134217728");
  expect_wrong("/nodes/0/children", {0}, "nodes[0]: is reached twice; expected nodes to form trees");
  expect_wrong("/nodes/0/children", {1}, "nodes[0].children[0]: expected an integer from 0 to 0");
  expect_wrong("/nodes/0/translation", {1, 2}, "nodes[0].translation: expected 3 numbers");
  expect_wrong("/nodes/0/scale", {1, 2, "x"}, "nodes[0].scale[2]: expected a number");
  expect_wrong("/nodes", {{{"scale", {1e308, 1, 1}}, {"children", {1}}}, {{"scale", {1e308, 1, 1}}}}, "nodes[1]: its transform is not finite");
  expect_wrong("/scene", 3, "scene: expected an integer from 0 to 1");
  expect_wrong("/accessors/0/sparse", Json::object(), "accessors[0]: sparse accessors are not supported");
  expect_wrong("/accessors/0/count", 1000000000000,
               "accessors[0]: 1000000000000 elements of 12 bytes, 12 apart, from byte 0 do not fit its bufferView of 48 bytes");
  expect_wrong("/accessors/0/type", "VEC9", "accessors[0]: unknown type; expected SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4");
  expect_wrong("/accessors/0/componentType", 5124, "accessors[0]: unknown componentType 5124");
  expect_wrong("/accessors/0/componentType", 5123, "meshes[0].primitives[0].attributes.POSITION: expected an accessor of VEC3 of floats");
  expect_wrong("/accessors/1/componentType", 5120, "meshes[0].primitives[0].indices: expected an accessor of unsigned integers");
  expect_wrong("/accessors/1/count", 2, "meshes[0].primitives[0]: triangles of 2 vertices; expected a multiple of 3");
  expect_wrong("/bufferViews/1/byteLength", 4, "bufferViews[1]: bytes 48 to 52 lie outside the buffer of 51 bytes");
  expect_wrong("/bufferViews/0/byteStride", 8, "bufferViews[0].byteStride: expected an integer from 12 to 252");
  expect_wrong("/bufferViews/0/buffer", 1, "bufferViews[0].buffer: expected an integer from 0 to 0");
  expect_wrong("/buffers/0/byteLength", 1000, "buffers[0]: has 52 bytes; expected 1000");
  expect_wrong("/buffers/0/uri", "a.bin", "buffers[0].uri: refers to another file, which is not read here");
  expect_wrong("/buffers/0/uri", "data:;base64,A*==", "buffers[0].uri: the data URI is no valid base64");
  expect_wrong("/buffers/0/uri", "data:,abc", "buffers[0].uri: expected a data URI in base64");
  Json without = good;
  without["meshes"][0]["primitives"][0]["attributes"].erase("POSITION");
  expect_error(glb(without, buffer), "meshes[0].primitives[0].attributes: 'POSITION' is missing");
}

}  // namespace
}  // namespace raymeter
