#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "experiments/scenes/scene_readers.h"
#include "tests/support/expect_error.h"

namespace raymeter {
namespace {

Scene read(const std::string& bytes) { return read_stl({"test.stl", bytes, std::nullopt}); }
void expect_error(const std::string& bytes, const std::string& message) {
  expect_error_message([&] { (void)read(bytes); }, message);
}

const std::string kFacet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 5e-1\nendloop\nendfacet\n";

/// A header that begins with "solid" and `count` facets with the vertices (0 0 0) (1 0 0) (0 1 x).
std::string binary(std::uint32_t count, float x = 0.5f) {
  std::string bytes = "solid in name only";
  bytes.resize(80, ' ');
  bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
  const float values[12] = {0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, x};
  for (std::uint32_t i = 0; i < count; ++i) bytes.append(reinterpret_cast<const char*>(values), sizeof values).append(2, '\0');
  return bytes;
}

TEST(StlReader, ReadsSolidsAsObjects) {
  const Scene scene = read("solid the first\n" + kFacet + kFacet + "endsolid the first\nsolid\n" + kFacet + "endsolid");
  EXPECT_EQ(scene.prim_count(), 3);
  ASSERT_EQ(scene.objects().size(), 2u);
  EXPECT_EQ(scene.objects()[0].name, "the first");
  EXPECT_EQ(scene.objects()[0].end_prim, 2);
  EXPECT_EQ(scene.objects()[1].name, "");
  EXPECT_EQ(scene.pools().triangles.vertex[2][2][0], 0.5f);
}

TEST(StlReader, ReadsBinaryFilesEvenIfTheyBeginWithSolid) {
  const Scene scene = read(binary(3));
  EXPECT_EQ(scene.prim_count(), 3);
  EXPECT_EQ(scene.objects().size(), 0u);
  EXPECT_EQ(scene.pools().triangles.vertex[1][0][2], 1.0f);
  EXPECT_EQ(scene.pools().triangles.vertex[2][2][2], 0.5f);
  EXPECT_EQ(read(binary(0)).prim_count(), 0);
}

TEST(StlReader, LetsTheSceneDropWhatIsNotFinite) {
  EXPECT_EQ(read(binary(2, std::numeric_limits<float>::infinity())).dropped_count(), 2);
  EXPECT_EQ(read("solid\nfacet normal 0 0 0 outer loop vertex nan 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet endsolid").dropped_count(), 1);
}

TEST(StlReader, SaysWhatIsWrong) {
  expect_error("", "test.stl: has 0 bytes; expected a text that begins with 'solid' or a binary header of 84 bytes");
  expect_error(std::string(100, '\0'), "test.stl: a binary STL file of 0 facets has 84 bytes, not 100");
  std::string garbage(90, '\xff');
  expect_error(garbage, "test.stl: a binary STL file of 4294967295 facets has 214748364834 bytes, not 90");
  std::string truncated = binary(2);
  truncated[0] = 'S';
  truncated.pop_back();
  expect_error(truncated, "test.stl: a binary STL file of 2 facets has 184 bytes, not 183");
  expect_error("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0", "test.stl:4: the file ends; expected a vertex coordinate");
  expect_error("solid a\n" + kFacet, "test.stl:9: the file ends; expected 'facet' or 'endsolid'");
  expect_error("solid a\nfacet normal 0 0 up", "test.stl:2: 'up' is not a number; expected a component of the normal");
  expect_error("solid a\nvertex 0 0 0", "test.stl:2: unknown 'vertex'; expected 'facet' or 'endsolid'");
  expect_error("solid a\nendsolid\nmore", "test.stl:3: unknown 'more'; expected 'solid'");
}

}  // namespace
}  // namespace raymeter
