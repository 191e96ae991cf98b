// What a scene needs, and that a frame by only that is the frame by everything.
#include <gtest/gtest.h>

#include <cstring>

#include "accel/registry.h"
#include "core/render/whitted.h"
#include "core/scene/scene_needs.h"
#include "experiments/scenes/scene_source.h"

namespace raymeter {
namespace {

Scene one_of_each() {
  Scene scene;
  scene.add_sphere({0, 0, 0}, 1);
  scene.add_triangle({3, 0, 0}, {4, 0, 0}, {3, 1, 0});
  scene.add_polygon(std::array<glm::dvec3, 4>{{{5, 0, 0}, {6, 0, 0}, {6, 1, 0}, {5, 1, 0}}});
  scene.add_cone({8, 0, 0}, 0.5, {8, 1, 0}, 0.2);
  return scene;
}

TEST(SceneNeeds, AreWhatIsThere) {
  Scene scene;
  EXPECT_EQ(needs_of(scene).text(), "");
  scene.lights.resize(1);
  EXPECT_EQ(needs_of(scene).text(), "lights") << "nothing can cast a shadow";
  scene.add_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  EXPECT_EQ(needs_of(scene).text(), "triangle lights shadows");
  scene.add_triangle({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, {{{0, 0, 1}, {0, 0, 1}, {0, 1, 1}}});
  EXPECT_EQ(needs_of(scene).text(), "triangle vertex_normals lights shadows");
  scene.lights.clear();
  scene.set_material({{1, 1, 1}, 0.5, 0.2, 10, 0, 1});
  scene.add_sphere({0, 0, 0}, 1);
  EXPECT_EQ(needs_of(scene).text(), "sphere triangle vertex_normals reflection");
  scene.set_material({{1, 1, 1}, 0.5, 0, 10, 0.3, 1.5});
  scene.add_sphere({0, 0, 3}, 1);
  EXPECT_EQ(needs_of(scene).text(), "sphere triangle vertex_normals reflection refraction");
  EXPECT_EQ(needs_of(one_of_each()).text(), "sphere triangle polygon cone");
  EXPECT_EQ(all_needs().text(), "sphere triangle polygon cone vertex_normals reflection refraction lights shadows");
}

TEST(SceneNeeds, ColumnsThatNoPrimitiveUsesTakeNoMemory) {
  Scene spheres, triangles;
  for (int i = 0; i < 1000; ++i) {
    spheres.add_sphere({i, 0, 0}, 0.5);
    triangles.add_triangle({i, 0, 0}, {i + 1, 0, 0}, {i, 1, 0});
  }
  spheres.finish();
  triangles.finish();
  const std::size_t padded = 1000 + kColumnPadding;
  EXPECT_EQ(spheres.pools().mem_bytes(), 5 * padded * 4) << "centre, radius, id";
  EXPECT_EQ(triangles.pools().mem_bytes(), 10 * padded * 4) << "nine coordinates, id; no normals";
}

struct Case {
  const char* name;
  Scene scene;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const char* spec : {"spd:tetra:4", "spd:balls:2", "spd:gears:1", "spd:mount:3", "spd:teapot:4", "gen:cloud:500"})
    all.push_back({spec, load_scene(spec)});
  const auto without_lights = [&](const char* name, Scene scene) {
    scene.lights.clear();
    all.push_back({name, std::move(scene)});
  };
  without_lights("matte without lights", load_scene("spd:tetra:4"));
  without_lights("glass without lights", load_scene("spd:gears:1"));
  Scene empty;
  empty.background = {0.1, 0.2, 0.3};
  all.push_back({"empty", std::move(empty)});
  return all;
}

TEST(SceneNeeds, AreEnoughForTheSameFrame) {
  for (const Case& c : cases()) {
    const ParamValues params = structure_entry("bvh").resolve({});
    const auto structure = structure_entry("bvh").build(c.scene, params, 1);
    const auto intersector = structure->intersector({best_isa(), 16, params});
    CastFirstHit cast(*intersector);
    for (const int depth : {1, 5}) {
      SCOPED_TRACE(std::string(c.name) + " depth " + std::to_string(depth));
      RenderOptions options{{c.scene.camera, CameraConvention::pixel, 64, 64}, {depth, 0}, 2, true};
      const Rendering needed = render(c.scene, cast, *intersector, options);
      options.general = true;
      const Rendering general = render(c.scene, cast, *intersector, options);
      EXPECT_EQ(needed.rays, general.rays);
      EXPECT_EQ(needed.depth, general.depth);
      EXPECT_EQ(needed.totals.sum().counters, general.totals.sum().counters);
      EXPECT_EQ(std::memcmp(needed.image.pixel.data(), general.image.pixel.data(), general.image.pixel.size() * sizeof(glm::vec3)), 0);
    }
  }
}

TEST(SceneNeeds, SayWhichRaysThereAre) {
  for (const Case& c : cases()) {
    const ParamValues params = structure_entry("list").resolve({});
    const auto structure = structure_entry("list").build(c.scene, params, 1);
    const auto intersector = structure->intersector({best_isa(), 16, params});
    CastFirstHit cast(*intersector);
    const SceneNeeds needs = needs_of(c.scene);
    const RayCounts rays = render(c.scene, cast, *intersector, {{c.scene.camera, CameraConvention::pixel, 32, 32}, {}, 1, false}).rays;
    EXPECT_TRUE(needs.lights || rays.shadow == 0) << c.name;
    EXPECT_TRUE(needs.reflection || needs.refraction || rays.reflection == 0) << c.name;
    EXPECT_TRUE(needs.refraction || rays.refraction + rays.tir == 0) << c.name;
  }
}

}  // namespace
}  // namespace raymeter
