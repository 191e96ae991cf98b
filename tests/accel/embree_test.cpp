#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "accel/embree/polygon_triangles.h"
#include "accel/registry.h"
#include "core/trace/trace.h"
#include "experiments/scenes/scene_source.h"
#include "tests/support/answer.h"
#include "tests/support/random.h"
#include "tests/support/test_rays.h"

namespace raymeter {
namespace {

const StructureEntry& embree() { return structure_entry("embree"); }

/// Skips, visibly, where this build or machine has no Embree.
#define SKIP_WITHOUT_EMBREE(scene) \
  if (const std::string why = embree().why_not((scene), best_isa()); !why.empty()) GTEST_SKIP() << why

/// Random lines from around the unit cube through it.
RayBatch lines_through_middle(int count) {
  test::Random random(7);
  RayBatch rays;
  for (int i = 0; i < count; ++i) {
    glm::dvec3 org, target;
    for (int a = 0; a < 3; ++a) {
      org[a] = random.uniform(-3, 3);
      target[a] = random.uniform(-1.2, 1.2);
    }
    rays.push_back(test::make_ray(org, target - org));
  }
  return rays;
}

struct Traced {
  HitBatch hits;
  Column<std::int32_t> blocker;
  std::string choice;
};

Traced traced(const Scene& scene, const RayBatch& rays, const std::string& technique, Isa isa) {
  const TechniqueSpec spec = parse_technique(technique);
  const auto structure = spec.structure->build(scene, spec.params, 2);
  const auto intersector = structure->intersector({isa, 16, spec.params});
  Traced out;
  intersector->prepare(rays.view(), Query::closest, 2);
  trace_closest(*intersector, rays, out.hits, 2);
  intersector->prepare(rays.view(), Query::any, 2);
  trace_any(*intersector, rays, out.blocker, 2);
  out.choice = intersector->choice(Query::closest);
  return out;
}

/// The peer rounds otherwise than raymeter: the same primitives, and distances that agree to a few roundings, but for rays that hit close to an edge.
void expect_close(const Traced& peer, const test::Answer& ours) {
  std::size_t others = 0;
  for (std::size_t i = 0; i < ours.hits.size(); ++i) {
    EXPECT_EQ(peer.blocker[i] >= 0, peer.hits.prim[i] >= 0);
    if (peer.hits.prim[i] != ours.hits.prim[i]) {
      ++others;
    } else if (ours.hits.prim[i] >= 0) {
      EXPECT_NEAR(peer.hits.t[i], ours.hits.t[i], 2e-5f * ours.hits.t[i]);
      EXPECT_NEAR(peer.hits.u[i], ours.hits.u[i], 1e-3f);
      EXPECT_NEAR(peer.hits.v[i], ours.hits.v[i], 1e-3f);
    } else {
      EXPECT_TRUE(std::isinf(peer.hits.t[i]));
    }
  }
  EXPECT_LE(others * 100, ours.hits.size());
}

void expect_all_modes_close(const std::string& spec) {
  const Scene scene = load_scene(spec);
  SKIP_WITHOUT_EMBREE(scene);
  const RayBatch rays = lines_through_middle(2085);
  for (const Isa isa : {Isa::sse42, Isa::avx2, Isa::avx512}) {
    if (!available(isa)) continue;
    const test::Answer ours = test::answer(scene, rays, "bvh", isa, 16);
    for (const char* mode : {"best", "single", "packet4", "packet8", "packet16", "stream", "stream_soa"}) {
      for (const char* layout : {"slice", "ahead"}) {
        SCOPED_TRACE(std::string(name(isa)) + " " + mode + " " + layout);
        const Traced peer = traced(scene, rays, std::string("embree:mode=") + mode + ",layout=" + layout, isa);
        expect_close(peer, ours);
        EXPECT_TRUE(peer.choice.starts_with("mode=")) << peer.choice;
      }
    }
    expect_close(traced(scene, rays, "embree:robust=true", isa), ours);
    expect_close(traced(scene, rays, "embree:quality=high", isa), ours);
  }
}

TEST(Embree, FindsTheSameTrianglesInEveryMode) { expect_all_modes_close("gen:icosphere:3"); }

TEST(Embree, FindsTheSameSpheresInEveryMode) { expect_all_modes_close("gen:spheres:500"); }

TEST(Embree, FindsTheSamePolygonsInEveryMode) { expect_all_modes_close("spd:gears:1"); }

TEST(Embree, FindsSpheresOnTheirGround) { expect_all_modes_close("spd:balls:2"); }

/// The area that a polygon's triangles cover, and its own by Newell's formula.
std::pair<double, double> areas(const PolygonPool& pool, const PolygonTriangles& triangles, std::int32_t polygon) {
  const auto vertex = [&](std::uint32_t i) { return glm::dvec3(pool.vertex[0][i], pool.vertex[1][i], pool.vertex[2][i]); };
  const auto first = static_cast<std::uint32_t>(pool.first_vertex[static_cast<std::size_t>(polygon)]);
  const auto end = static_cast<std::uint32_t>(pool.first_vertex[static_cast<std::size_t>(polygon) + 1]);
  glm::dvec3 newell(0.0);
  for (std::uint32_t i = first + 1; i + 1 < end; ++i) newell += glm::cross(vertex(i) - vertex(first), vertex(i + 1) - vertex(first));
  double covered = 0;
  for (std::size_t i = 0; i < triangles.vertex.size(); ++i) {
    const auto& [a, b, c] = triangles.vertex[i];
    if (triangles.polygon[i] == polygon) covered += glm::length(glm::cross(vertex(b) - vertex(a), vertex(c) - vertex(a)));
  }
  return {covered, glm::length(newell)};
}

TEST(PolygonTriangles, CoverConcavePolygonsOnce) {
  for (const char* const spec : {"spd:gears:2", "spd:mount:3", "spd:balls:1"}) {
    const Scene scene = load_scene(spec);
    const PolygonPool& pool = scene.pools().polygons;
    const PolygonTriangles triangles = triangles_of(pool);
    for (std::int32_t polygon = 0; polygon < static_cast<std::int32_t>(pool.size()); ++polygon) {
      const auto [covered, own] = areas(pool, triangles, polygon);
      EXPECT_NEAR(covered, own, 1e-6 * own) << spec << " polygon " << polygon;
    }
  }
}

TEST(PolygonTriangles, JoinHolesAndEndOnHopelessOutlines) {
  Scene scene;
  // A square with a square hole, joined to it by an edge that is gone along twice.
  scene.add_polygon(std::vector<glm::dvec3>{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {0, 0, 0}, {1, 1, 0}, {1, 3, 0}, {3, 3, 0}, {3, 1, 0}, {1, 1, 0}});
  scene.add_polygon(std::vector<glm::dvec3>{{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 3, 0}});                        // crosses itself
  scene.add_polygon(std::vector<glm::dvec3>{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {1, 0, 0}});             // no area
  scene.add_polygon(std::vector<glm::dvec3>{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}});  // straight corners, one of them twice
  scene.finish();
  const PolygonPool& pool = scene.pools().polygons;
  ASSERT_EQ(pool.size(), 4u);
  const PolygonTriangles triangles = triangles_of(pool);
  EXPECT_DOUBLE_EQ(areas(pool, triangles, 0).first, 2 * 12.0);
  EXPECT_EQ(std::ranges::count(triangles.polygon, 2), 0);
  EXPECT_DOUBLE_EQ(areas(pool, triangles, 3).first, 2 * 4.0);
}

/// Where a neighbour's corner lies on a straight edge, that is a corner of ours: a triangle must end there, or rays find a gap beside it.
TEST(PolygonTriangles, EndAtStraightCorners) {
  Scene scene;
  const glm::dvec3 x = glm::normalize(glm::dvec3(3, 1, 2)), y = glm::normalize(glm::cross(x, glm::dvec3(1, 5, -2)));
  const auto add = [&](std::initializer_list<glm::dvec2> corners) {
    std::vector<glm::dvec3> vertices;
    for (const glm::dvec2& c : corners) vertices.push_back(c.x * x + c.y * y);
    scene.add_polygon(vertices);
  };
  scene.add_polygon(std::vector<glm::dvec3>{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 2, 0}});  // a triangle with a corner amid an edge
  scene.add_polygon(std::vector<glm::dvec3>{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {2, 2, 0}, {1, 2, 0}, {0, 2, 0}, {0, 1, 0}});
  scene.add_polygon(std::vector<glm::dvec3>{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1.5, 0.5, 0}, {1, 1, 0}, {0.5, 0.5, 0}});  // amid all edges
  add({{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 1}, {2, 1}, {1, 1}, {0, 1}});                                                 // straight but for rounding
  add({{0, 0}, {4, 0}, {4, 4}, {2, 4}, {2, 2}, {1, 2}, {0, 2}});                                                         // concave
  scene.finish();
  const PolygonPool& pool = scene.pools().polygons;
  const PolygonTriangles triangles = triangles_of(pool);
  for (std::int32_t polygon = 0; polygon < static_cast<std::int32_t>(pool.size()); ++polygon) {
    const auto [covered, own] = areas(pool, triangles, polygon);
    EXPECT_NEAR(covered, own, 1e-6 * own) << "polygon " << polygon;
    const auto first = static_cast<std::uint32_t>(pool.first_vertex[static_cast<std::size_t>(polygon)]);
    const auto end = static_cast<std::uint32_t>(pool.first_vertex[static_cast<std::size_t>(polygon) + 1]);
    EXPECT_EQ(std::ranges::count(triangles.polygon, polygon), end - first - 2) << "polygon " << polygon;
    for (std::uint32_t v = first; v < end; ++v) {
      const bool used = std::ranges::any_of(triangles.vertex, [&](const auto& triangle) { return std::ranges::count(triangle, v) > 0; });
      EXPECT_TRUE(used) << "polygon " << polygon << ", corner " << v - first;
    }
  }
}

TEST(Embree, LetsInvalidRaysMissAndLeavesTheirNeighboursAlone) {
  const Scene scene = load_scene("gen:icosphere:3");
  SKIP_WITHOUT_EMBREE(scene);
  const RayBatch good = lines_through_middle(64);
  RayBatch mixed = good;
  const float nan = std::nanf("");
  for (std::size_t i = 0; i < mixed.size(); i += 3) {
    Ray ray = good[i];
    if (i % 2 == 0)
      ray.org[1] = nan;
    else
      ray.t_max = -1;
    mixed.set(i, ray);
  }
  for (const char* mode : {"single", "packet4", "packet8", "packet16", "stream", "stream_soa"}) {
    SCOPED_TRACE(mode);
    const std::string technique = std::string("embree:mode=") + mode;
    const Traced alone = traced(scene, good, technique, best_isa());
    const Traced among = traced(scene, mixed, technique, best_isa());
    for (std::size_t i = 0; i < good.size(); ++i) {
      EXPECT_EQ(among.hits.prim[i], i % 3 == 0 ? -1 : alone.hits.prim[i]);
      EXPECT_EQ(among.blocker[i] >= 0, i % 3 != 0 && alone.blocker[i] >= 0);
    }
  }
}

TEST(Embree, MissesWithRaysBeyondItsRangeAndDoesNotEndTheProgram) {
  const Scene scene = load_scene("gen:icosphere:3");
  SKIP_WITHOUT_EMBREE(scene);
  RayBatch rays = lines_through_middle(64);
  for (std::size_t i = 0; i < rays.size(); i += 2) {
    Ray ray = rays[i];
    (i % 4 == 0 ? ray.dir : ray.org)[i % 3] = 1e20f;
    rays.set(i, ray);
  }
  for (const char* mode : {"single", "packet4", "packet8", "packet16", "stream", "stream_soa"}) {
    for (const char* coherence : {"coherent", "incoherent"}) {
      SCOPED_TRACE(std::string(mode) + ", " + coherence);
      const Traced answers = traced(scene, rays, std::string("embree:mode=") + mode + ",coherence=" + coherence, best_isa());
      for (std::size_t i = 0; i < rays.size(); i += 2) EXPECT_EQ(answers.hits.prim[i], -1);
    }
  }
}

TEST(Embree, SaysWhatItCannotServe) {
  const Scene triangles = load_scene("gen:icosphere:1");
  SKIP_WITHOUT_EMBREE(triangles);
  EXPECT_NE(embree().why_not(triangles, Isa::scalar), "");
  const Scene cones = load_scene("spd:tree:2");
  EXPECT_NE(embree().why_not(cones, best_isa()).find("cones"), std::string::npos);
  EXPECT_THROW((void)embree().build(cones, embree().resolve({}), 1), Error);
}

TEST(Embree, StandsBehindTheStructuresAndNotAmongThem) {
  EXPECT_TRUE(std::ranges::none_of(structures(), &StructureEntry::peer));
  EXPECT_EQ(structures_and_peers().back().name, "embree");
}

}  // namespace
}  // namespace raymeter
