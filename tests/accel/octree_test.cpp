#include <gtest/gtest.h>

#include <bit>
#include <string>

#include "tests/support/answer.h"
#include "tests/support/grid_rays.h"

namespace raymeter {
namespace {

using namespace test;

constexpr const char* kTrackings[] = {"parametric", "point_location", "neighbour"};

/// Every tracking, on every instruction set, against the list.
void expect_equals_list(const Scene& scene, const RayBatch& rays, const std::string& build) {
  for (const Isa isa : kIsas) {
    if (!available(isa)) continue;
    const Answer list = answer(scene, rays, "list", isa, simd_width(isa));
    for (const char* tracking : kTrackings) {
      for (const int packet : {1, 64}) {
        const std::string technique = "octree:" + build + ",tracking=" + tracking;
        const Answer octree = answer(scene, rays, technique, isa, packet);
        int differ = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
          if (std::bit_cast<std::uint32_t>(list.hits.t[i]) == std::bit_cast<std::uint32_t>(octree.hits.t[i]) && list.hits.prim[i] == octree.hits.prim[i] &&
              (list.hits.prim[i] >= 0) == (octree.blocker[i] >= 0)) {
            continue;
          }
          if (++differ > 3) continue;
          const Ray r = rays[i];
          ADD_FAILURE() << technique << " " << name(isa) << " packet " << packet << " ray " << i << " (" << r.org[0] << " " << r.org[1] << " " << r.org[2]
                        << ") (" << r.dir[0] << " " << r.dir[1] << " " << r.dir[2] << ") t_min " << r.t_min << ": list " << list.hits.prim[i] << " at "
                        << list.hits.t[i] << ", octree " << octree.hits.prim[i] << " at " << octree.hits.t[i] << ", blocked by " << octree.blocker[i];
        }
        EXPECT_EQ(differ, 0) << technique << " " << name(isa) << " packet " << packet;
      }
    }
  }
}

TEST(Octree, EqualsListBitForBit) {
  const Scene scene = mixed_scene(2000, 0.1);
  for (const char* build :
       {"placement=exact,leaf_size=1", "placement=box", "split=cost", "placement=box,split=cost,cost_planes=ends,cost_middle=mean_of_all", "max_depth=1",
        "max_depth=0", "root=cube", "placement=box,cone_padding=0.1,thin_padding=0.2,start=origin", "placement=box,cone_padding=0.1,padding_sides=low"}) {
    expect_equals_list(scene, random_rays(200), build);
  }
}

std::int64_t references(const Scene& scene, const std::string& padding) {
  const TechniqueSpec spec = parse_technique("octree:placement=box,leaf_size=1,max_depth=4" + padding);
  return spec.structure->build(scene, spec.params, 1)->stats().references;
}

TEST(Octree, PadsTheBoxesOfConesOnTheSidesAskedFor) {
  const Scene scene = mixed_scene(400, 0.1);
  const std::int64_t low = references(scene, ",cone_padding=0.05,padding_sides=low"), both = references(scene, ",cone_padding=0.05");
  EXPECT_GT(low, references(scene, ""));
  EXPECT_GT(both, low);
}

TEST(Octree, PadsBoxesOfPolygonsAlongAxesWhereTheyAreThin) {
  Scene scene;
  scene.add_sphere({-4, -4, -4}, 0.5);  // the box is [-4.5, 4.5]^3: its planes go through the origin
  scene.add_sphere({4, 4, 4}, 0.5);
  scene.add_triangle({0.25, 1, 1}, {0.25, 2, 1}, {0.25, 1, 2});
  const std::array<glm::dvec3, 4> square{glm::dvec3(-2, 0.25, -2), {-1, 0.25, -2}, {-1, 0.25, -1}, {-2, 0.25, -1}};
  scene.add_polygon(square);
  scene.finish();
  const auto listed = [&](const char* padding) { return references(scene, std::string(",max_depth=1,thin_padding=") + padding); };
  EXPECT_EQ(listed("0"), 4);
  EXPECT_EQ(listed("0.2"), 4) << "does not reach the planes";
  EXPECT_EQ(listed("0.3"), 6) << "both do, across x and y";
  EXPECT_EQ(listed("0.9"), 6) << "they are 1 wide along the other axes";
}

TEST(Octree, EqualsListAtHugeAndTinyCoordinates) {
  for (const double scale : {1e-8, 1e8}) {
    expect_equals_list(mixed_scene(400, 0.2, scale), random_rays(300, scale), "leaf_size=1,max_depth=6");
    expect_equals_list(mixed_scene(400, 0.2, 1, glm::dvec3(scale)), random_rays(300, 1, glm::dvec3(scale)), "leaf_size=1,max_depth=6");
  }
  expect_equals_list(mixed_scene(400, 0.2, 1, {1e4, -3e4, 0}), random_rays(300, 1, {1e4, -3e4, 0}), "leaf_size=1,max_depth=6");
}

/// Primitives whose faces, edges and corners lie on the planes of an octree over [0, 8]^3 that is divided three times.
Scene lattice_scene() {
  std::mt19937 random(4);
  const auto corner = [&] { return glm::dvec3(random() % 9, random() % 9, random() % 9); };
  Scene scene;
  scene.add_triangle({0, 0, 0}, {8, 0, 0}, {0, 8, 8});
  scene.add_triangle({8, 8, 8}, {0, 8, 0}, {8, 0, 8});
  for (int i = 0; i < 300; ++i) {
    const glm::dvec3 a = corner();
    const int axis = static_cast<int>(random() % 3);
    glm::dvec3 b(0.0), c(0.0);
    b[(axis + 1) % 3] = a[(axis + 1) % 3] < 8 ? 1 : -1;
    c[(axis + 2) % 3] = a[(axis + 2) % 3] < 8 ? 1 : -1;
    const std::array<glm::dvec3, 4> quad{a, a + b, a + b + c, a + c};
    if (i % 3 == 0)
      scene.add_polygon(quad);
    else
      scene.add_triangle(a, a + b, a + c);
  }
  scene.finish();
  return scene;
}

TEST(Octree, EqualsListOnPlanesEdgesAndCorners) {
  for (const char* build : {"growth=0,leaf_size=1,max_depth=5,placement=exact", "growth=0,leaf_size=1,max_depth=5,placement=box"}) {
    expect_equals_list(lattice_scene(), lattice_rays(2000, 8), build);
  }
}

TEST(Octree, FindsWhatLiesLeftRightOrInThePlaneThatDividesACell) {
  for (const double x : {-0.5, 0.0, 0.5}) {
    Scene scene;
    scene.add_sphere({-4, -4, -4}, 0.5);  // the box is [-4.5, 4.5]^3: its planes go through the origin
    scene.add_sphere({4, 4, 4}, 0.5);
    scene.add_triangle({x, -2, 1}, {x, 2, 1}, {x, 0, 3});
    scene.finish();
    RayBatch rays;
    for (int i = 0; i < 27 * 3; ++i) {
      // From the common corner of the eight cells, and from beside the plane, in all 26 directions, with either zero.
      const glm::dvec3 dir(i % 3 - 1, i / 3 % 3 - 1, i / 9 % 3 - 1);
      if (dir == glm::dvec3(0.0)) continue;
      rays.push_back(ray({i / 27 == 0 ? 0 : x, 0, i / 27 == 2 ? 2 : 0}, dir));
      Ray negative_zero = rays[rays.size() - 1];
      for (float& d : negative_zero.dir) d = d == 0 ? -0.0f : d;
      rays.push_back(negative_zero);
    }
    expect_equals_list(scene, rays, "growth=0,leaf_size=1");
  }
}

TEST(Octree, EqualsListForFarOrigins) {
  const Scene scene = mixed_scene(300, 0.2);
  for (const double distance : {10.0, 1e3, 1e5, 1e12}) {
    std::mt19937 random(5);
    RayBatch rays;
    for (int i = 0; i < 100; ++i) {
      const glm::dvec3 from = distance * (2.0 * point(random) - 1.0);
      rays.push_back(ray(from, point(random) - from));
    }
    for (const char* placement : {"placement=exact", "placement=box"}) expect_equals_list(scene, rays, std::string(placement) + ",leaf_size=1,max_depth=5");
  }
}

TEST(Octree, HandlesDegenerateScenes) {
  const RayBatch rays = random_rays(200);
  Scene empty, one, same, concentric, points;
  one.add_sphere({0.5, 0.5, 0.5}, 0.4);
  for (int i = 0; i < 3000; ++i) same.add_triangle({0, 0, 0}, {1, 0, 1}, {0, 1, 1});
  for (int i = 1; i <= 256; ++i) concentric.add_sphere({0.5, 0.5, 0.5}, i / 256.0);
  for (int i = 0; i < 100; ++i) points.add_sphere({0.5, 0.5, 0.5}, 0);
  for (Scene* scene : {&empty, &one, &same, &concentric, &points}) {
    scene->finish();
    expect_equals_list(*scene, rays, "leaf_size=1");
  }
  Scene flat, huge;
  std::mt19937 random(6);
  for (int i = 0; i < 500; ++i) {
    const glm::dvec3 p = point(random) * glm::dvec3(1, 1, 0), e(0.05 * uniform(random), 0, 0), f(0, 0.05 * uniform(random), 0);
    flat.add_triangle(p, p + e, p + f);
    huge.add_triangle(3e38 * (2.0 * point(random) - 1.0), 3e38 * (2.0 * point(random) - 1.0), 3e38 * (2.0 * point(random) - 1.0));
  }
  flat.finish();
  huge.finish();
  expect_equals_list(flat, rays, "leaf_size=1");
  expect_equals_list(huge, rays, "leaf_size=1");
}

TEST(Octree, FindsASmallModelInAHugeHall) {
  Scene scene;
  scene.add_triangle({-1e4, -1e4, 0}, {1e4, -1e4, 0}, {0, 1e4, 0});
  for (int i = 0; i < 200; ++i) scene.add_sphere({5e3 + i % 10, 5e3 + i / 10, 5 + i % 7}, 0.4);
  scene.finish();
  std::mt19937 random(7);
  RayBatch rays;
  for (int i = 0; i < 500; ++i) {
    const glm::dvec3 from(5e3 + 40 * uniform(random) - 15, 5e3 + 40 * uniform(random) - 15, 30 * uniform(random));
    rays.push_back(ray(from, glm::dvec3(5e3, 5e3, 5) + point(random) * glm::dvec3(10, 20, 7) - from));
  }
  for (const char* least : {"16", "0.5"}) expect_equals_list(scene, rays, std::string("leaf_size=1,max_depth=20,least_cell=") + least);
}

}  // namespace
}  // namespace raymeter
