#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "experiments/scenes/scene_readers.h"
#include "tests/support/expect_error.h"

namespace raymeter {
namespace {

Scene read(const std::string& text) { return read_nff({"test.nff", text, std::nullopt}); }
void expect_error(const std::string& text, const std::string& message) {
  expect_error_message([&] { (void)read(text); }, message);
}

constexpr const char* kView = "v from 1 2 3 at 4 5 6 up 0 0 1 angle 30 hither 0.5 resolution 64 32\n";

TEST(NffReader, ReadsEveryEntity) {
  const Scene scene = read(std::string("# a comment\nb .1 .2 .3\n") + kView +
                           "l 1 1 1 l 2 2 2 .5 .6 .7 # two lights on a line\nf 1 .9 .8 .7 .6 5 .4 1.3\ns 1 2 3 4\nc 0 0 0 2\n 0 0 1 1\n"
                           "p 3 0 0 0  1 0 0  0 1 0\np 4 0 0 0 1 0 0 1 1 0 0 1 0\npp 3 0 0 0 0 0 1 1 0 0 0 1 1 0 1 0 1 0 1\nf 0 0 0 1 0 0 0 0\ns 0 0 0 1");
  EXPECT_EQ(scene.background, glm::dvec3(.1, .2, .3));
  EXPECT_EQ(scene.camera, (Camera{{1, 2, 3}, {4, 5, 6}, {0, 0, 1}, 30, 0.5, 64, 32}));
  ASSERT_EQ(scene.lights.size(), 2u);
  EXPECT_EQ(scene.lights[0].color, glm::dvec3(1 / std::sqrt(2.0)));
  EXPECT_EQ(scene.lights[1], (Light{{2, 2, 2}, {.5, .6, .7}}));
  ASSERT_EQ(scene.prim_count(), 6);
  constexpr std::array kKinds{PrimKind::sphere, PrimKind::cone, PrimKind::triangle, PrimKind::polygon, PrimKind::triangle, PrimKind::sphere};
  for (std::int32_t id = 0; id < 6; ++id) EXPECT_EQ(scene.prim(id).kind(), kKinds[static_cast<std::size_t>(id)]) << id;
  EXPECT_EQ(scene.material(4), (Material{{1, .9, .8}, .7, .6, 5, .4, 1.3}));
  EXPECT_EQ(scene.material(5), (Material{{0, 0, 0}, 1, 0, 0, 0, 0}));
  const TrianglePool& triangles = scene.pools().triangles;
  EXPECT_EQ(triangles.normal_index[0], -1);
  EXPECT_EQ(triangles.normal_index[1], 0);
  EXPECT_EQ(triangles.normal[2][0][0], 1.0f);
}

TEST(NffReader, LetsTheSceneDropWhatIsNotFinite) {
  const Scene scene = read("s nan 0 0 1 s 0 0 0 1 p 3 0 0 0 1e999 0 0 0 1 0 s 0 0 0 -1 s 0 1e-999 0 1");
  EXPECT_EQ(scene.prim_id_count(), 5);
  EXPECT_EQ(scene.prim_count(), 2);
  EXPECT_EQ(scene.dropped_count(), 3);
  EXPECT_TRUE(scene.prim(0).dropped());
  EXPECT_FALSE(scene.prim(1).dropped());
}

TEST(NffReader, GivesFilesWithoutViewADefaultOne) {
  for (const char* text : {"", "# nothing\n", "s 5 6 7 1"}) {
    const Scene scene = read(text);
    ASSERT_EQ(scene.lights.size(), 1u);
    EXPECT_EQ(scene.camera.look_at, scene.prim_count() == 0 ? glm::dvec3(0) : glm::dvec3(5, 6, 7));
    // The bounding sphere of the box touches the field of view's edge: sin(fov / 2) = radius / distance.
    const double radius = scene.prim_count() == 0 ? 1 : std::sqrt(3.0);
    EXPECT_NEAR(glm::length(scene.camera.eye - scene.camera.look_at), radius / std::sin(std::acos(-1.0) / 8), 1e-12);
  }
}

TEST(NffReader, NamesLineAndExpectationOfWhatIsWrong) {
  expect_error("s 1 2", "test.nff:1: the file ends; expected a coordinate of the sphere's centre");
  expect_error("\n\ns 1 2 three 4", "test.nff:3: 'three' is not a number; expected a coordinate of the sphere's centre");
  expect_error("v from 1 2 3 at 1 2 3 up 0 1 0", "test.nff:1: 'at' is where 'from' is; expected another point");
  expect_error("b 0 0 0\nq 1", "test.nff:2: unknown entity 'q'; expected one of v b l f s c p pp #");
  expect_error("\x01\xff", "test.nff:1: unknown entity '\\x01\\xff'; expected one of v b l f s c p pp #");
  expect_error("p 2 0 0 0 1 1 1", "test.nff:1: '2' is not allowed; expected the number of vertices, an integer from 3 to 2147483647");
  expect_error("p 2147483647 0 0 0", "test.nff:1: the file ends; expected a vertex coordinate");
  expect_error("p 99999999999999999999", "test.nff:1: '99999999999999999999' is not allowed; expected the number of vertices, an integer from 3 to 2147483647");
  expect_error("v from 0 0 0\nto 1 1 1", "test.nff:2: unknown 'to'; expected 'at'");
  expect_error("v from 1 2 3 at 4 5 6 up 0 0 1 angle 180 hither 0 resolution 1 1", "test.nff:1: the angle of view must lie between 0 and 180 degrees");
  expect_error("l nan 0 0", "test.nff:1: a coordinate of the light must be finite");
}

}  // namespace
}  // namespace raymeter
