// The shadow cache's entries: what each is of, when it is written and when it is forgotten.
#include <gtest/gtest.h>

#include <memory>
#include <ostream>
#include <string_view>
#include <vector>

#include "accel/registry.h"
#include "core/render/occlusion.h"
#include "tests/support/shadows.h"

namespace raymeter {
namespace {

using test::Blockers;
using test::Shadow;

/// A floor whose two halves are one object; above it the spheres A and B, and a light that all rays go up to.
struct Garden {
  Scene scene;
  std::unique_ptr<Structure> structure;
  std::unique_ptr<Intersector> intersector;

  Garden() {
    scene.begin_object("floor");
    scene.add_triangle({-50, 0, -50}, {50, 0, -50}, {50, 0, 50});
    scene.add_triangle({-50, 0, -50}, {50, 0, 50}, {-50, 0, 50});
    scene.end_object();
    scene.add_sphere({0, 5, 0}, 1);
    scene.add_sphere({10, 5, 0}, 1);
    scene.lights.assign(2, Light{});
    scene.finish();
    structure = structure_entry("list").build(scene, structure_entry("list").resolve({}), 1);
    intersector = structure->intersector({Isa::scalar, 1, structure_entry("list").resolve({})});
  }
  [[nodiscard]] std::unique_ptr<Occlusion> cache(std::string_view variant) { return test::cache_of(scene, variant, {}, *intersector); }
};

/// A ray for each letter: to sphere A or B, or F, free. `from` are primitives, one or one for each letter.
Shadow rays_to(std::string_view letters, std::vector<std::int32_t> from = {0}, std::int32_t light = 0) {
  Shadow shadow;
  for (std::size_t i = 0; i < letters.size(); ++i) {
    const float x = letters[i] == 'A' ? 0.0f : letters[i] == 'B' ? 10.0f : 20.0f;
    shadow.rays.push_back({{x, 0.5f, 0}, 0, {0, 1, 0}, 100});
    shadow.origins.push_back(light, from[i % from.size()]);
  }
  return shadow;
}

struct Hits {
  std::uint64_t tests, hits;
  friend bool operator==(const Hits&, const Hits&) = default;
  friend std::ostream& operator<<(std::ostream& out, const Hits& h) { return out << h.tests << " tests, " << h.hits << " hits"; }
};

Hits hits_of(Occlusion& cache, const Shadow& shadow) {
  Blockers blockers;
  const Counters counters = test::find(cache, shadow, 1, blockers);
  return {counters.live(Event::cache_test), counters.live(Event::cache_hit)};
}

TEST(ShadowCacheEntries, HoldTheLastBlocker) {
  Garden garden;
  EXPECT_EQ(hits_of(*garden.cache("key=light,update=serial"), rays_to("FAABBFA")), (Hits{5, 2}));
  EXPECT_EQ(hits_of(*garden.cache("key=light,update=serial,forget=true"), rays_to("FAABBFA")), (Hits{4, 2})) << "a free ray empties its entry";
}

TEST(ShadowCacheEntries, AreForgottenWhereAFrameBegins) {
  Garden garden;
  const auto cache = garden.cache("key=light,update=serial");
  EXPECT_EQ(hits_of(*cache, rays_to("AA")), (Hits{1, 1}));
  EXPECT_EQ(hits_of(*cache, rays_to("AA")), (Hits{2, 2})) << "batches of a frame go on";
  cache->begin();
  EXPECT_EQ(hits_of(*cache, rays_to("AA")), (Hits{1, 1}));
}

TEST(ShadowCacheEntries, AreThoseOfLightsObjectsAndNodes) {
  Garden garden;
  const Shadow alternating = rays_to("ABABAB", {2, 3});
  EXPECT_EQ(hits_of(*garden.cache("key=light,update=serial"), alternating), (Hits{5, 0}));
  EXPECT_EQ(hits_of(*garden.cache("key=light_object,update=serial"), alternating), (Hits{4, 4}));
  EXPECT_EQ(hits_of(*garden.cache("key=light_object,update=serial"), rays_to("AA", {0, 1})), (Hits{1, 1})) << "both are of one composite";
  EXPECT_EQ(hits_of(*garden.cache("key=light_object,update=serial"), rays_to("AA", {1, 2})), (Hits{0, 0})) << "these are not";
  const auto by_light = garden.cache("key=light,update=serial");
  EXPECT_EQ(hits_of(*by_light, rays_to("AA", {0}, 0)), (Hits{1, 1}));
  EXPECT_EQ(hits_of(*by_light, rays_to("A", {0}, 1)), (Hits{0, 0})) << "another light";
  const auto by_node = garden.cache("key=light_tree,update=serial");
  Shadow reflected = rays_to("A");
  reflected.origins.node = RayTree::reflection(RayTree::kEye);
  EXPECT_EQ(hits_of(*by_node, rays_to("AA")), (Hits{1, 1}));
  EXPECT_EQ(hits_of(*by_node, reflected), (Hits{0, 0})) << "another node";
  EXPECT_EQ(hits_of(*by_node, reflected), (Hits{1, 1}));
}

TEST(ShadowCacheEntries, ChangeBetweenBatchesAlone) {
  Garden garden;
  EXPECT_EQ(hits_of(*garden.cache("key=light,batch=2"), rays_to("AAAAABB")), (Hits{5, 4})) << "AA | AA | AB | B: the last ray of a batch counts";
  EXPECT_EQ(hits_of(*garden.cache("key=light,batch=100"), rays_to("AAAAABB")), (Hits{0, 0}));
}

}  // namespace
}  // namespace raymeter
