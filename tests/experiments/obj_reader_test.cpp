#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "experiments/scenes/obj_materials.h"
#include "experiments/scenes/scene_readers.h"
#include "tests/support/expect_error.h"

namespace raymeter {
namespace {

Scene read(const std::string& text) { return read_obj({"test.obj", text, std::nullopt}); }
void expect_error(const std::string& text, const std::string& message) {
  expect_error_message([&] { (void)read(text); }, message);
}

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(ObjReader, ReadsFacesGroupsAndNegativeIndices) {
  const Scene scene =
      read("# comment\n" + kSquare + "vn 0 0 1\nvn 0 1 1\nvt 0 0\nf 1 2 3\no thing\ng empty\ng left arm\nf -4 -2 \\\n -1 # continued\nf 1/1 2/1 3/1 4/1\n" +
           "s off\nl 1 2\no other\nf 1//1 2//2 3//1\nf 1/1/1 2/1/1 3/1/-1\n");
  EXPECT_EQ(scene.prim_count(), 5);
  ASSERT_EQ(scene.objects().size(), 2u);
  EXPECT_EQ(scene.objects()[0].name, "left arm");
  EXPECT_EQ(scene.objects()[0].first_prim, 1);
  EXPECT_EQ(scene.objects()[0].end_prim, 3);
  EXPECT_EQ(scene.objects()[1].name, "other");
  EXPECT_EQ(scene.object_count(), 3);
  EXPECT_EQ(scene.prim(2).kind(), PrimKind::polygon);
  const TrianglePool& triangles = scene.pools().triangles;
  EXPECT_EQ(triangles.vertex[1][1][1], 1.0f);  // vertex -2 of the second triangle
  EXPECT_EQ(triangles.normal_index[1], -1);
  EXPECT_EQ(triangles.normal[1][1][0], 1.0f);
  EXPECT_EQ(triangles.normal[2][1][1], 1.0f);
}

TEST(ObjReader, TakesMaterialsFromTheLibrariesBesideTheFile) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "raymeter_obj_reader";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "my colors.mtl") << "newmtl red\nKd 0.5 0.25 0\nKs .1 .2 .3\nNs 20\nd 0.75\nNi 1.5\nmap_Kd red.png\nnewmtl grey one\nKd .5\nTr 0.5\n";
  const std::string text = kSquare + "mtllib missing.mtl\nmtllib my colors.mtl\nf 1 2 3\nusemtl red\nf 1 2 3\nusemtl grey one\nf 1 2 3\nusemtl none\nf 1 2 3\n";
  const Scene scene = read_obj({"test.obj", text, folder});
  std::filesystem::remove_all(folder);
  EXPECT_EQ(scene.material(0), Material{});
  EXPECT_EQ(scene.material(1), (Material{{1, 0.5, 0}, 0.5, 0.3, 20, 0.25, 1.5}));
  EXPECT_EQ(scene.material(2), (Material{{1, 1, 1}, 0.5, 0, 0, 0.5, 1}));
  EXPECT_EQ(scene.material(3), Material{});
}

TEST(ObjReader, LetsTheSceneDropWhatIsNotFinite) {
  const Scene scene = read(kSquare + "v nan 0 0\nv 0 1e39 0\nf 1 2 3\nf 1 2 5\nf 1 2 6\n");
  EXPECT_EQ(scene.prim_id_count(), 3);
  EXPECT_EQ(scene.dropped_count(), 2);
}

TEST(ObjReader, TakesAFileWithoutFacesAsAnEmptyScene) {
  EXPECT_EQ(read("").prim_count(), 0);
  EXPECT_EQ(read(kSquare).prim_count(), 0);
}

TEST(ObjReader, NamesLineAndExpectationOfWhatIsWrong) {
  expect_error("garbage", "test.obj:1: unknown statement 'garbage'; expected one of v vn vt f o g usemtl mtllib or another of the format");
  expect_error("v 0 0\nv 1 1 1", "test.obj:1: the line ends; expected a vertex coordinate");
  expect_error("v 0 0 x", "test.obj:1: 'x' is not a number; expected a vertex coordinate");
  expect_error(kSquare + "f 1 2", "test.obj:5: a face has 2 vertices; expected at least 3");
  expect_error(kSquare + "f 1 2 5", "test.obj:5: vertex index 5 is out of range; 4 are defined so far, counted from 1");
  expect_error(kSquare + "f 1 2 0", "test.obj:5: vertex index 0 is out of range; 4 are defined so far, counted from 1");
  expect_error(kSquare + "f -1 -2 -5", "test.obj:5: vertex index -5 is out of range; 4 are defined so far, counted from 1");
  expect_error(kSquare + "f 1//1 2//1 3//1", "test.obj:5: normal index 1 is out of range; 0 are defined so far, counted from 1");
  expect_error(kSquare + "f 1/1 2/1 3/1", "test.obj:5: texture vertex index 1 is out of range; 0 are defined so far, counted from 1");
  expect_error(kSquare + "f 1 2 3.5", "test.obj:5: '3.5' is no index of a vertex");
  expect_error(kSquare + "f 1 2 1/1/1/1", "test.obj:5: '1/1/1/1' is no corner of a face; expected VERTEX/TEXTURE/NORMAL");
  expect_error_message([] { (void)read_mtl({"a.mtl", "Kd 1 1 1", std::nullopt}); }, "a.mtl:1: 'Kd' comes before any material; expected 'newmtl'");
  expect_error_message([] { (void)read_mtl({"a.mtl", "newmtl a\nd half", std::nullopt}); }, "a.mtl:2: 'half' is not a number; expected a number from 0 to 1");
}

}  // namespace
}  // namespace raymeter
