#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <string>

#include "tests/support/answer.h"
#include "tests/support/grid_rays.h"

namespace raymeter {
namespace {

using namespace test;

void expect_equals_list(const Scene& scene, const RayBatch& rays, const std::string& technique) {
  for (const Isa isa : kIsas) {
    if (!available(isa)) continue;
    const Answer list = answer(scene, rays, "list", isa, simd_width(isa));
    for (const int packet : {1, 5, 16, 64}) {
      const Answer grid = answer(scene, rays, technique, isa, packet);
      int differ = 0;
      for (std::size_t i = 0; i < rays.size(); ++i) {
        if (std::bit_cast<std::uint32_t>(list.hits.t[i]) == std::bit_cast<std::uint32_t>(grid.hits.t[i]) && list.hits.prim[i] == grid.hits.prim[i] &&
            (list.hits.prim[i] >= 0) == (grid.blocker[i] >= 0)) {
          continue;
        }
        if (++differ > 3) continue;
        const Ray r = rays[i];
        ADD_FAILURE() << technique << " " << name(isa) << " packet " << packet << " ray " << i << " (" << r.org[0] << " " << r.org[1] << " " << r.org[2]
                      << ") (" << r.dir[0] << " " << r.dir[1] << " " << r.dir[2] << ") t_min " << r.t_min << ": list " << list.hits.prim[i] << " at "
                      << list.hits.t[i] << ", grid " << grid.hits.prim[i] << " at " << grid.hits.t[i] << ", blocked by " << grid.blocker[i];
      }
      EXPECT_TRUE(bits_equal(list.hits, grid.hits)) << technique << " " << name(isa) << " packet " << packet << ": " << differ;
    }
  }
}

TEST(Grid, EqualsListBitForBit) {
  const Scene scene = mixed_scene(2000, 0.1);
  for (const char* technique : {"grid", "grid:density=0.1", "grid:density=40", "grid:resolution=1x40x3", "grid:mailbox=off", "grid:blocker=nearest",
                                "grid:growth_low=0.3,growth_high=0.05,cone_padding=0.1,margin=0,start=origin"}) {
    expect_equals_list(scene, random_rays(1500), technique);
  }
}

TEST(Grid, FindsTheNearestBlockerWhereThatIsAskedFor) {
  const Scene scene = mixed_scene(2000, 0.1);
  const Answer found = answer(scene, random_rays(1500), "grid:blocker=nearest,mailbox=off", Isa::scalar, 1);
  EXPECT_TRUE(std::ranges::equal(found.blocker, found.hits.prim));
}

TEST(Grid, EqualsListAtHugeAndTinyCoordinates) {
  for (const double scale : {1e-8, 1e8}) {
    expect_equals_list(mixed_scene(400, 0.2, scale), random_rays(500, scale), "grid:density=20");
    expect_equals_list(mixed_scene(400, 0.2, 1, glm::dvec3(scale)), random_rays(500, 1, glm::dvec3(scale)), "grid:density=20");
  }
  expect_equals_list(mixed_scene(400, 0.2, 1, {1e4, -3e4, 0}), random_rays(1000, 1, {1e4, -3e4, 0}), "grid:density=20");
}

/// Primitives whose faces, edges and corners lie on the planes of an 8 x 8 x 8 grid.
Scene lattice_scene() {
  std::mt19937 random(4);
  const auto corner = [&] { return glm::dvec3(random() % 9, random() % 9, random() % 9); };
  Scene scene;
  scene.add_triangle({0, 0, 0}, {8, 0, 0}, {0, 8, 8});  // spans the box, so that the cells have size 1
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

TEST(Grid, EqualsListOnPlanesEdgesAndCorners) { expect_equals_list(lattice_scene(), lattice_rays(10000, 8), "grid:resolution=8x8x8"); }

TEST(Grid, EqualsListForFarOrigins) {
  const Scene scene = mixed_scene(300, 0.2);
  for (const double distance : {10.0, 1e3, 1e5, 1e7, 1e12}) {
    std::mt19937 random(5);
    RayBatch rays;
    for (int i = 0; i < 500; ++i) {
      const glm::dvec3 from = distance * (2.0 * point(random) - 1.0);
      rays.push_back(ray(from, point(random) - from));
    }
    expect_equals_list(scene, rays, "grid:resolution=64x32x128");
  }
}

TEST(Grid, HandlesDegenerateScenes) {
  const RayBatch rays = random_rays(200);
  Scene empty, one, same, concentric, points;
  one.add_sphere({0.5, 0.5, 0.5}, 0.4);
  for (int i = 0; i < 3000; ++i) same.add_triangle({0, 0, 0}, {1, 0, 1}, {0, 1, 1});
  for (int i = 1; i <= 256; ++i) concentric.add_sphere({0.5, 0.5, 0.5}, i / 256.0);
  for (int i = 0; i < 100; ++i) points.add_sphere({0.5, 0.5, 0.5}, 0);
  for (Scene* scene : {&empty, &one, &same, &concentric, &points}) {
    scene->finish();
    expect_equals_list(*scene, rays, "grid");
  }
  Scene flat, huge;
  std::mt19937 random(6);
  for (int i = 0; i < 500; ++i) {
    const glm::dvec3 p = point(random) * glm::dvec3(1, 1, 0), e(0.05 * uniform(random), 0, 0), f(0, 0.05 * uniform(random), 0);
    flat.add_triangle(p, p + e, p + f);
    huge.add_triangle(3e38 * (2.0 * point(random) - 1.0), 3e38 * (2.0 * point(random) - 1.0), 3e38 * (2.0 * point(random) - 1.0));
  }
  expect_equals_list(flat, rays, "grid:density=16");
  expect_equals_list(huge, rays, "grid");
}

TEST(Grid, FindsTheOccluderBeforeTheEndOfALargeTriangle) {
  Scene scene;
  scene.add_triangle({-10, -10, 0}, {10, -10, 8}, {0, 30, 4});  // met far behind the cell in which it is tested first
  scene.add_triangle({5, -1, 4}, {5, 1, 4}, {5, 0, 6.5});
  scene.add_sphere({-9.9, 0, 7.9}, 0.1);
  RayBatch rays;
  rays.push_back(ray({-9, 0, 5}, {1, 0, 0}));
  rays.push_back(ray({-9, 0, 5}, {1, 0, 0}, 13.9f));
  expect_equals_list(scene, rays, "grid:resolution=20x1x1");
  const Answer grid = answer(scene, rays, "grid:resolution=20x1x1", Isa::scalar, 1);
  EXPECT_EQ(grid.hits.prim[0], 0);
  EXPECT_EQ(grid.hits.prim[1], 0);
}

}  // namespace
}  // namespace raymeter
