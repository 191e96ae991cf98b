#pragma once

// Rays made to keep traversals from ending, and what each of them takes alone.

#include <cstdint>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "core/bounds/aabb.h"
#include "tests/support/answer.h"
#include "tests/support/grid_rays.h"

namespace raymeter::test {

inline constexpr int kAdversarialRays = 1000000;

/// Triangles, squares and spheres on whole coordinates 0 .. n, in units of `unit`: planes, of halves and of the heuristic, pass through vertices, edges and
/// faces.
inline Scene lattice_scene(int n, int count, double unit = 1) {
  std::mt19937 random(11);
  Scene scene;
  const auto corner = [&] {
    glm::dvec3 p;
    for (glm::length_t a = 0; a < 3; ++a) p[a] = unit * static_cast<double>(random() % (static_cast<unsigned>(n) + 1));
    return p;
  };
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 p = corner();
    const auto a = static_cast<glm::length_t>(random() % 3);
    glm::dvec3 u(0.0), v(0.0);
    u[(a + 1) % 3] = v[(a + 2) % 3] = unit;
    switch (i % 4) {
      case 0: scene.add_triangle(p, p + u, p + v); break;
      case 1: scene.add_polygon(std::array{p, p + u, p + u + v, p + v}); break;
      case 2: scene.add_sphere(p, 0.5 * unit); break;
      default: scene.add_triangle(p, corner(), corner());
    }
  }
  scene.finish();
  return scene;
}

/// Rays on the faces, edges and corners of the primitives' padded boxes, which are those of all nodes above them, or just beside.
inline RayBatch box_rays(int count, const Scene& scene) {
  Planes planes;
  for (std::int32_t id = 0; id < scene.prim_id_count(); ++id) {
    const Aabb box = padded_bounds(scene.pools(), scene.prim(id));
    for (std::size_t a = 0; a < 3; ++a) {
      planes[a].push_back(box.min[static_cast<glm::length_t>(a)]);
      planes[a].push_back(box.max[static_cast<glm::length_t>(a)]);
    }
  }
  return plane_rays(count, planes);
}

/// What rays find that are traced alone, and of each event the count of the ray that has the most of it.
struct Alone {
  HitBatch hits;
  Column<std::int32_t> blocker;
  Counters most;
};

/// Each ray by a call of its own.
inline Alone trace_alone(const Structure& structure, const TechniqueSpec& spec, Isa isa, const RayBatch& rays) {
  const auto tracer = structure.intersector({isa, 1, spec.params});
  Column<std::byte> scratch(std::max<std::size_t>(64, tracer->scratch_bytes()));
  Alone out;
  out.hits.resize(rays.size());
  out.blocker.resize(rays.size(), -1);
  const auto each = [&](Query query, auto&& trace_one) {
    tracer->prepare(rays.view(), query, 1);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      Counters counters;
      trace_one(i, &counters);
      for (std::size_t e = 0; e < kEventCount; ++e) out.most.rays[e] = std::max(out.most.rays[e], counters.rays[e]);
    }
  };
  each(Query::closest, [&](std::size_t i, Counters* counters) { tracer->closest_hit(rays.view(i, 1), out.hits.view(i, 1), counters, scratch.data()); });
  each(Query::any, [&](std::size_t i, Counters* counters) { tracer->any_hit(rays.view(i, 1), out.blocker.data() + i, counters, scratch.data()); });
  return out;
}

inline void expect_as_list(const HitBatch& hits, const Column<std::int32_t>& blocker, const HitBatch& list) {
  ASSERT_EQ(hits.size(), list.size());
  const auto same = [](float x, float y) { return std::bit_cast<std::uint32_t>(x) == std::bit_cast<std::uint32_t>(y); };
  for (std::size_t i = 0; i < hits.size(); ++i) {
    ASSERT_EQ(hits.prim[i], list.prim[i]) << "ray " << i;
    ASSERT_TRUE(same(hits.t[i], list.t[i]) && same(hits.u[i], list.u[i]) && same(hits.v[i], list.v[i])) << "ray " << i;
    ASSERT_EQ(blocker[i] >= 0, list.prim[i] >= 0) << "ray " << i;
  }
}

/// The most that rays took alone, by the way and the size of the structure that they went through.
struct Steps {
  std::uint64_t nodes, leaves, prim_tests;
  BuildStats stats;
};

/// Traces the rays alone and in packets of 64, for nearest and any hits, and expects the list's answers.
inline Steps expect_to_end_as_list(const Scene& scene, const RayBatch& rays, std::string_view technique, Isa isa, const HitBatch& list) {
  SCOPED_TRACE(std::string(technique) + ", " + std::string(name(isa)));
  const TechniqueSpec spec = parse_technique(technique);
  const auto structure = spec.structure->build(scene, spec.params, 2);
  const Alone alone = trace_alone(*structure, spec, isa, rays);
  expect_as_list(alone.hits, alone.blocker, list);
  const auto tracer = structure->intersector({isa, kMaxPacket, spec.params});
  HitBatch hits;
  Column<std::int32_t> blocker;
  tracer->prepare(rays.view(), Query::closest, 2);
  trace_closest(*tracer, rays, hits, 2);
  tracer->prepare(rays.view(), Query::any, 2);
  trace_any(*tracer, rays, blocker, 2);
  expect_as_list(hits, blocker, list);
  return {alone.most.live(Event::node_visit), alone.most.live(Event::leaf_visit), alone.most.live(Event::prim_test), structure->stats()};
}

}  // namespace raymeter::test
