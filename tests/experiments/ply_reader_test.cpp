#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "experiments/scenes/scene_readers.h"
#include "tests/support/expect_error.h"

namespace raymeter {
namespace {

Scene read(const std::string& bytes) { return read_ply({"test.ply", bytes, std::nullopt}); }
void expect_error(const std::string& bytes, const std::string& message) {
  expect_error_message([&] { (void)read(bytes); }, message);
}

const std::string kVertexHeader = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
const std::string kVertices = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

std::string ascii(const std::string& elements, const std::string& data) { return "ply\nformat ascii 1.0\n" + elements + "end_header\n" + data; }

/// Appends a value in either byte order.
template <class T>
void put(std::string& bytes, T value, bool big_endian) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  if (big_endian) std::reverse(raw, raw + sizeof(T));
  bytes.append(raw, sizeof(T));
}

/// One triangle (0, 2, 1) of vertices (i, 10 i, 100 i^2), with an index type, and with things to skip before, in and between the elements.
template <class Index>
std::string binary(const std::string& index_type, bool big_endian) {
  std::string bytes = std::string("ply\r\nformat binary_") + (big_endian ? "big" : "little") +
                      "_endian 1.0\r\ncomment any words\r\nelement before 2\r\nproperty list ushort short l\r\nelement vertex 3\r\nproperty double y\r\n"
                      "property list uint8 float32 skipped\r\nproperty int16 x\r\nproperty uchar red\r\nproperty float z\r\nelement nothing 1000000000\r\n"
                      "element face 1\r\nproperty uint flags\r\nproperty list int " +
                      index_type + " vertex_index\r\nend_header\r\n";
  put<std::uint16_t>(bytes, 0, big_endian);
  put<std::uint16_t>(bytes, 1, big_endian);
  put<std::int16_t>(bytes, -7, big_endian);
  for (std::int16_t i = 0; i < 3; ++i) {
    put<double>(bytes, 10.0 * i, big_endian);
    put<std::uint8_t>(bytes, static_cast<std::uint8_t>(i), big_endian);
    for (int k = 0; k < i; ++k) put<float>(bytes, 5.0f, big_endian);
    put<std::int16_t>(bytes, i, big_endian);
    put<std::uint8_t>(bytes, 255, big_endian);
    put<float>(bytes, 100.0f * static_cast<float>(i * i), big_endian);
  }
  put<std::uint32_t>(bytes, 1, big_endian);
  put<std::int32_t>(bytes, 3, big_endian);
  for (const int index : {0, 2, 1}) put<Index>(bytes, static_cast<Index>(index), big_endian);
  return bytes;
}

template <class Index>
void expect_triangle(const std::string& index_type) {
  for (const bool big_endian : {false, true}) {
    const Scene scene = read(binary<Index>(index_type, big_endian));
    ASSERT_EQ(scene.prim_count(), 1) << index_type << big_endian;
    const TrianglePool& triangles = scene.pools().triangles;
    for (const std::size_t k : {0u, 1u, 2u}) {
      const float index = static_cast<float>(std::array{0, 2, 1}[k]);
      EXPECT_EQ(triangles.vertex[k][0][0], index);
      EXPECT_EQ(triangles.vertex[k][1][0], 10 * index);
      EXPECT_EQ(triangles.vertex[k][2][0], 100 * index * index);
    }
  }
}

TEST(PlyReader, ReadsBothByteOrdersAndEveryIndexTypeAndSkipsTheRest) {
  expect_triangle<std::int8_t>("char");
  expect_triangle<std::uint8_t>("uchar");
  expect_triangle<std::int16_t>("short");
  expect_triangle<std::uint16_t>("uint16");
  expect_triangle<std::int32_t>("int32");
  expect_triangle<std::uint32_t>("uint");
}

TEST(PlyReader, ReadsAsciiFacesInFileOrder) {
  const Scene scene = read(ascii(kVertexHeader + "element face 3\nproperty list uchar int vertex_indices\n", kVertices + "3 0 1 2\n4 0 1 2 3\n3 0 2 3\n"));
  ASSERT_EQ(scene.prim_count(), 3);
  EXPECT_EQ(scene.prim(0).kind(), PrimKind::triangle);
  EXPECT_EQ(scene.prim(1).kind(), PrimKind::polygon);
  EXPECT_EQ(scene.prim(2).kind(), PrimKind::triangle);
  EXPECT_EQ(scene.object_count(), 3);
}

TEST(PlyReader, KeepsVertexNormals) {
  const Scene scene =
      read(ascii("element vertex 3\nproperty float nx\nproperty float ny\nproperty float nz\nproperty float x\nproperty float y\nproperty float z\n"
                 "element face 1\nproperty list uchar int vertex_indices\n",
                 "0 0 1 0 0 0\n0 1 1 1 0 0\n1 0 1 0 1 0\n3 0 1 2\n"));
  const TrianglePool& triangles = scene.pools().triangles;
  ASSERT_EQ(triangles.normal_index.size(), 1u);
  EXPECT_EQ(triangles.normal[1][1][0], 1.0f);
  EXPECT_EQ(triangles.normal[2][0][0], 1.0f);
}

TEST(PlyReader, LetsTheSceneDropWhatIsNotFinite) {
  const Scene scene =
      read(ascii(kVertexHeader + "element face 2\nproperty list uchar int vertex_indices\n", "0 0 0\n1 0 nan\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n"));
  EXPECT_EQ(scene.prim_id_count(), 2);
  EXPECT_EQ(scene.dropped_count(), 1);
}

TEST(PlyReader, TakesFilesWithoutFacesAsEmptyScenes) {
  EXPECT_EQ(read(ascii("", "")).prim_count(), 0);
  EXPECT_EQ(read(ascii(kVertexHeader, kVertices)).prim_count(), 0);
}

TEST(PlyReader, NamesLineAndExpectationOfWhatIsWrongInTheHeader) {
  expect_error("", "test.ply:1: the file ends; expected 'ply'");
  expect_error("garbage", "test.ply:1: unknown 'garbage'; expected 'ply'");
  expect_error("ply\nformat ascii", "test.ply:2: the file ends; expected '1.0'");
  expect_error("ply\nformat utf8 1.0\n", "test.ply:2: unknown format 'utf8'; expected ascii, binary_little_endian or binary_big_endian");
  expect_error("ply\nformat ascii 1.0\nelement vertex 3\n", "test.ply:4: the file ends; expected 'end_header'");
  expect_error("ply\nformat ascii 1.0\nelement vertex -1\n",
               "test.ply:3: '-1' is not allowed; expected the number of entries, an integer from 0 to 2147483647");
  expect_error("ply\nformat ascii 1.0\nproperty float x\n",
               "test.ply:3: unknown 'property'; expected element, property (of an element), comment, obj_info or end_header");
  expect_error(ascii("element vertex 1\nproperty half x\n", ""),
               "test.ply:4: unknown type 'half'; expected the property's type: char uchar short ushort int uint float or double");
  expect_error(ascii("element vertex 1\nproperty list float int x\n", ""), "test.ply:4: the length of a list must have an integer type");
  expect_error(ascii("element vertex 2000000000\nproperty float x\n", "0"),
               "test.ply: element 'vertex' has 2000000000 entries of at least 2 bytes, but only 1 bytes follow the header");
  expect_error(ascii("element vertex 1\nproperty float x\nproperty float y\n", "0 0 0"),
               "test.ply:7: element 'vertex' has no property 'z'; expected numbers x, y and z");
  expect_error(ascii(kVertexHeader + "element face 1\nproperty list uchar float vertex_indices\n", kVertices + "3 0 1 2"),
               "test.ply:13: element 'face' needs one property 'vertex_indices', a list of integers");
  expect_error(ascii("element face 1\nproperty list uchar int vertex_indices\n", "3 0 1 2"),
               "test.ply:6: element 'face' comes without vertices; expected element 'vertex' before it");
  expect_error(ascii(kVertexHeader + kVertexHeader, kVertices + kVertices), "test.ply:15: a second element 'vertex'; expected one");
}

TEST(PlyReader, NamesPlaceAndExpectationOfWhatIsWrongInTheData) {
  const std::string face = "element face 1\nproperty list char int vertex_indices\n";
  expect_error(ascii(kVertexHeader + face, kVertices + "3 0 1 4"), "test.ply:14: vertex index 4 is out of range; expected 0 to 3");
  expect_error(ascii(kVertexHeader + face, kVertices + "3 0 1 -1"), "test.ply:14: vertex index -1 is out of range; expected 0 to 3");
  expect_error(ascii(kVertexHeader + face, kVertices + "2 0 1 0"), "test.ply:14: a face has 2 vertices; expected at least 3");
  expect_error(ascii(kVertexHeader + face, kVertices + "-3 0 1 0"), "test.ply:14: list 'vertex_indices' has the negative length -3");
  expect_error(ascii(kVertexHeader + face, "0 0 zero\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2"), "test.ply:10: 'zero' is not a number; expected a number");
  expect_error(ascii(kVertexHeader + face, kVertices + "9 0 1 2 3"), "test.ply:14: the file ends; expected an index or a list's length");
  std::string bytes = binary<std::int32_t>("int", false);
  bytes.pop_back();
  expect_error(bytes, "test.ply: byte " + std::to_string(bytes.size() - 3) + ": the file ends within its data");
}

}  // namespace
}  // namespace raymeter
