#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

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
