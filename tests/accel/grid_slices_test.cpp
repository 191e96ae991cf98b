#include <string>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "experiments/scenes/scene_source.h"
#include "tests/support/adversarial.h"
#include "tests/support/answer.h"
#include "tests/support/grid_rays.h"
#include "tests/support/traces.h"

namespace raymeter {
namespace {

using namespace test;

/// Rays of a camera at `eye` that looks at `target`, side / 8 tiles of 8 x 8 on a side.
RayBatch tiled_rays(const glm::dvec3& eye, const glm::dvec3& target, double width, int side) {
  const glm::dvec3 forward = target - eye;
  const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(0.1, 0.3, 1))) * width, up = glm::normalize(glm::cross(right, forward)) * width;
  RayBatch rays;
  for (int i = 0; i < side * side; ++i) {
    const int tile = i / 64, x = i % 8 + tile % (side / 8) * 8, y = i / 8 % 8 + tile / (side / 8) * 8;
    rays.push_back(ray(eye, forward + right * (static_cast<double>(x) / side - 0.5) + up * (static_cast<double>(y) / side - 0.5)));
  }
  return rays;
}

glm::dvec3 corner(const Scene& scene, int triangle, int vertex) {
  const auto& columns = scene.pools().triangles.vertex[static_cast<std::size_t>(vertex)];
  const auto i = static_cast<std::size_t>(triangle);
  return {columns[0][i], columns[1][i], columns[2][i]};
}

struct Box {
  glm::dvec3 low{1e30}, high{-1e30};
};

Box box_of(const Scene& mesh) {
  Box box;
  for (int i = 0; i < mesh.prim_count(); ++i) {
    for (int v = 0; v < 3; ++v) {
      box.low = glm::min(box.low, corner(mesh, i, v));
      box.high = glm::max(box.high, corner(mesh, i, v));
    }
  }
  return box;
}

void expect_same(const Scene& scene, const RayBatch& rays, const std::string& technique, Isa isa, int packet) {
  SCOPED_TRACE(technique + " " + std::string(name(isa)) + " packet " + std::to_string(packet));
  const Answer list = answer(scene, rays, "list", isa, packet), grid = answer(scene, rays, technique, isa, packet);
  expect_same_hits(grid.hits, list.hits, rays);
  for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_EQ(grid.blocker[i] >= 0, list.hits.prim[i] >= 0) << "ray " << i;
}

TEST(GridSlices, AgreeWithTheListOnRaysThatStayTogetherAlongEveryAxis) {
  const Scene scene = mixed_scene(600, 0.2);
  const glm::dvec3 center(0.5);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      glm::dvec3 eye(0.45, 0.6, 0.52);
      eye[axis] = 0.5 + 2 * side;
      const RayBatch rays = tiled_rays(eye, center, 0.8, 32);
      for (const Isa isa : kIsas) {
        if (!available(isa)) continue;
        for (const int packet : {7, 16, 64}) expect_same(scene, rays, "grid:traversal=slices,resolution=16x11x13", isa, packet);
      }
    }
  }
}

TEST(GridSlices, AgreeWithTheListAimedAtVerticesAndFromFar) {
  const Scene terrain = load_scene("gen:terrain:2000");
  RayBatch rays;
  std::mt19937 random(5);
  const Box box = box_of(terrain);
  const glm::dvec3 size = box.high - box.low;
  for (int bundle = 0; bundle < 60; ++bundle) {
    const double distance = bundle % 3 == 0 ? 40 : bundle % 3 == 1 ? 2 : 0.3;
    const glm::dvec3 eye = box.low + size * (0.5 + distance * (point(random) - 0.5)) + glm::dvec3(0, 0, distance * size.x);
    const int first = static_cast<int>(random() % static_cast<unsigned>(terrain.prim_count()));
    for (int r = 0; r < 16; ++r) rays.push_back(ray(eye, corner(terrain, (first + r / 3) % terrain.prim_count(), r % 3) - eye));
  }
  for (const Isa isa : kIsas) {
    if (available(isa)) expect_same(terrain, rays, "grid:traversal=slices", isa, 16);
  }
}

TEST(GridSlices, ExecuteFewerStepsAndTestsThanLanes) {
  const Scene terrain = load_scene("gen:terrain:20000");
  const Box box = box_of(terrain);
  const glm::dvec3 center = 0.5 * (box.low + box.high), size = box.high - box.low;
  const RayBatch rays = tiled_rays(center + glm::dvec3(0.3, -0.7, 0.8) * size.x, center, 0.9 * size.x, 256);
  for (const Isa isa : kIsas) {
    if (!available(isa) || simd_width(isa) == 1) continue;
    const Counters lanes = answer(terrain, rays, "grid", isa, 64).closest;
    const Counters slices = answer(terrain, rays, "grid:traversal=slices", isa, 64).closest;
    EXPECT_LT(slices.executed(Event::node_visit), slices.live(Event::node_visit)) << name(isa);
    EXPECT_LT(slices.executed(Event::prim_test), lanes.executed(Event::prim_test)) << name(isa);
  }
}

TEST(GridSlices, TestATriangleOnceForARay) {
  Scene scene;
  for (int i = 0; i < 50; ++i) scene.add_triangle({0, 0, 0}, {16, 0, 0}, {0, 16, 16});
  scene.finish();
  const RayBatch rays = tiled_rays({8, -4, 8}, {8, 0, 8}, 1, 32);  // the triangle goes from one side to the other
  const Counters on = answer(scene, rays, "grid:traversal=slices,resolution=16x16x16", best_isa(), 64).closest;
  const Counters off = answer(scene, rays, "grid:traversal=slices,resolution=16x16x16,mailbox=off", best_isa(), 64).closest;
  EXPECT_LE(on.live(Event::prim_test), 50u * rays.size());
  EXPECT_GT(off.live(Event::prim_test), 2 * on.live(Event::prim_test));
}

/// Each ray and three more that are nearly the same, so that packets of four stay together.
RayBatch in_bundles_of_four(const RayBatch& alone) {
  RayBatch rays;
  for (std::size_t i = 0; i < alone.size(); ++i) {
    Ray r = alone[i];
    for (std::size_t copy = 0; copy < 4; ++copy) {
      if (copy > 0) r.org[copy - 1] = std::nextafter(r.org[copy - 1], copy % 2 == 0 ? kInf : -kInf);
      rays.push_back(r);
    }
  }
  return rays;
}

Scene three_in_eight_cells() {
  Scene scene;
  scene.add_triangle({0, 0, 4}, {8, 0, 4}, {0, 8, 4});
  scene.add_triangle({8, 8, 8}, {8, 8, 0}, {0, 8, 0});
  scene.add_sphere({2, 2, 2}, 2);
  scene.finish();
  return scene;
}

/// The most cells that four rays visit that are traced in one packet by a call of their own.
std::uint64_t most_cells_of_four(const Scene& scene, const RayBatch& rays, const std::string& technique, Isa isa) {
  const TechniqueSpec spec = parse_technique(technique);
  const auto structure = spec.structure->build(scene, spec.params, 1);
  const auto tracer = structure->intersector({isa, 4, spec.params});
  Column<std::byte> scratch(std::max<std::size_t>(64, tracer->scratch_bytes()));
  HitBatch hits;
  hits.resize(4);
  std::uint64_t most = 0;
  for (std::size_t i = 0; i < rays.size(); i += 4) {
    Counters counters;
    tracer->closest_hit(rays.view(i, 4), hits.view(), &counters, scratch.data());
    most = std::max(most, counters.live(Event::node_visit));
  }
  return most;
}

TEST(GridSlices, EndForAMillionAdversarialRaysAndAnswerAsTheList) {
  const Scene scene = three_in_eight_cells();
  const RayBatch rays = lattice_rays(kAdversarialRays, 8);
  for (const Isa isa : {Isa::scalar, best_isa()}) {
    const HitBatch list = answer(scene, rays, "list", isa, 64).hits;
    for (const char* technique : {"grid:resolution=8x8x8", "grid:resolution=8x8x8,traversal=slices"}) {
      const Steps steps = expect_to_end_as_list(scene, rays, technique, isa, list);
      EXPECT_EQ(steps.nodes, 8u + 8u + 8u - 2u) << technique;  // a ray alone goes from cell to cell
    }
  }
}

TEST(GridSlices, EndForAMillionAdversarialRaysThatStayTogether) {
  const Scene scene = three_in_eight_cells();
  const RayBatch rays = in_bundles_of_four(lattice_rays(kAdversarialRays / 4, 8));
  const std::string cells = "grid:resolution=8x8x8", slices = cells + ",traversal=slices";
  for (const Isa isa : {Isa::scalar, best_isa()}) {
    for (const std::string& technique : {cells, slices}) expect_same(scene, rays, technique, isa, 4);
    EXPECT_LE(most_cells_of_four(scene, rays, cells, isa), 4u * (8u + 8u + 8u - 2u)) << name(isa);
    // Slices are met once each, and in each the beam's rectangle of cells.
    EXPECT_LE(most_cells_of_four(scene, rays, slices, isa), 4u * 8u * 8u * 8u) << name(isa);
  }
}

TEST(GridParams, RefusesSlicesFromTheOrigin) { EXPECT_THROW((void)parse_technique("grid:traversal=slices,start=origin"), Error); }

}  // namespace
}  // namespace raymeter
