// Ray classification against the list: adversarial rays, small budgets, threads and history; what it counts and what it refuses.

#include <algorithm>
#include <fstream>
#include <span>
#include <string>

#include <gtest/gtest.h>

#include <malloc.h>

#include "accel/ray_classification/ray_classification.h"
#include "accel/ray_classification/ray_space.h"
#include "accel/weak_settings.h"
#include "core/trace/on_demand.h"
#include "experiments/scenes/scene_source.h"
#include "tests/support/adversarial.h"
#include "tests/support/random.h"
#include "tests/support/test_rays.h"
#include "tests/support/traces.h"

namespace raymeter {
namespace {

Aabb box_of(const Scene& scene) {
  Aabb box;
  for (std::int32_t id = 0; id < scene.prim_id_count(); ++id) {
    if (!scene.prim(id).dropped()) box.grow(padded_bounds(scene.pools(), scene.prim(id)));
  }
  return box;
}

/// A direction with components that tie, vanish with either sign, are denormal or huge: slopes of 0, -0 and +-1, and those where cells of slopes meet.
glm::dvec3 hard_direction(test::Random& random) {
  for (;;) {
    glm::dvec3 dir;
    for (glm::length_t a = 0; a < 3; ++a) {
      switch (random.below(8)) {
        case 0: dir[a] = 0.0; break;
        case 1: dir[a] = -0.0; break;
        case 2: dir[a] = random.below(2) == 0 ? 1 : -1; break;
        case 3: dir[a] = std::ldexp(random.uniform(-1, 1), -130); break;
        case 4: dir[a] = std::ldexp(static_cast<double>(random.below(2049)) - 1024, -10); break;
        case 5: dir[a] = std::nextafterf(random.below(2) == 0 ? 1.0f : -1.0f, random.below(2) == 0 ? 2.0f : -2.0f); break;
        default: dir[a] = random.uniform(-1, 1);
      }
    }
    if (random.below(8) == 0) dir *= std::ldexp(1.0, static_cast<int>(random.below(200)) - 100);
    if (glm::vec3(dir) != glm::vec3(0.0f)) return dir;
  }
}

/// Rays from corners, edges and faces of five-dimensional cells and of the scene's box, from inside and outside of it, near and beyond reach.
RayBatch adversarial_rays(const Scene& scene, std::size_t count, std::uint64_t seed) {
  test::Random random(seed);
  const Aabb box = box_of(scene);
  const RaySpace space(box, RayClassificationParams{});
  RayBatch rays;
  rays.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    glm::dvec3 org;
    for (glm::length_t a = 0; a < 3; ++a) {
      const double extent = double{box.max[a]} - double{box.min[a]};
      const int splits = static_cast<int>(random.below(11));
      switch (random.below(6)) {
        case 0: org[a] = double{box.min[a]}; break;
        case 1: org[a] = double{box.max[a]}; break;
        case 2: org[a] = double{std::nextafterf(box.max[a], random.below(2) == 0 ? 1e30f : -1e30f)}; break;
        case 3: org[a] = double{box.min[a]} + extent * random.uniform(-1, 2); break;
        default: org[a] = space.border(a, splits, static_cast<std::uint32_t>(random.below((std::size_t{1} << splits) + 1)));
      }
    }
    if (random.below(50) == 0) org *= 100;
    const glm::dvec3 dir =
        random.below(4) == 0
            ? test::point_of(scene, scene.prim(static_cast<std::int32_t>(random.below(static_cast<std::size_t>(scene.prim_id_count())))), random) - org
            : hard_direction(random);
    rays.push_back(test::make_ray(org, dir));
  }
  return rays;
}

/// Two hundred and fifty thousand of them on each of four scenes.
TEST(RayClassification, AMillionAdversarialRaysHitWhatTheListHits) {
  for (const char* name : {"mixed", "flat", "huge among tiny", "cones"}) {
    const Scene& scene = test::scene_named(name);
    SCOPED_TRACE(name);
    const RayBatch rays = adversarial_rays(scene, test::kAdversarialRays / 4, 11);
    const HitBatch list = test::answer(scene, rays, "list", best_isa(), 64).hits;
    // Small cells; and cells with long lists, which the beams of packets cull.
    for (const char* technique : {"ray_classification:min_rays=4", "ray_classification:min_rays=2000,beams=true"}) {
      const test::Steps steps = test::expect_to_end_as_list(scene, rays, technique, best_isa(), list);
      EXPECT_EQ(steps.nodes, 0u);
      EXPECT_EQ(steps.leaves, 1u) << "a ray is in one cell";
      EXPECT_LE(steps.prim_tests, static_cast<std::uint64_t>(scene.prim_count())) << "and tests no primitive twice";
    }
  }
}

/// Packets take from the lists of their cells what their own beams meet, and lose nothing, whatever the rays.
TEST(RayClassification, BeamsOfPacketsSaveTestsAndChangeNoAnswer) {
  for (const char* name : {"mixed", "cones", "huge among tiny"}) {
    const Scene& scene = test::scene_named(name);
    const RayBatch coherent = test::coherent_rays(scene);
    const test::Reference reference(scene, best_isa());
    for (const RayBatch* rays : {&coherent, &reference.rays}) {
      std::array<test::Traced, 2> traced;
      for (const bool beams : {false, true}) {
        const TechniqueSpec spec = parse_technique(beams ? "ray_classification:min_rays=1000,beams=true" : "ray_classification:min_rays=1000");
        const auto structure = spec.structure->build(scene, spec.params, 1);
        traced[beams ? 1 : 0] = test::trace(*structure, {best_isa(), kMaxPacket, spec.params}, *rays);
      }
      test::expect_same_hits(traced[1].hits, traced[0].hits, *rays);
      for (std::size_t i = 0; i < rays->size(); ++i) EXPECT_EQ(traced[1].blockers[i] < 0, traced[0].blockers[i] < 0) << i;
      if (rays == &coherent) {
        EXPECT_LT(traced[1].closest.live(Event::prim_test), traced[0].closest.live(Event::prim_test)) << name;
      }
    }
  }
}

TEST(RayClassification, BudgetsChangeCountsAndNoAnswer) {
  const Scene scene = load_scene("gen:terrain:2000");
  const test::Reference reference(scene, best_isa());
  for (const int packet : {1, 16}) {
    SCOPED_TRACE(packet);
    std::uint64_t before = ~std::uint64_t{0};
    for (const char* budget : {"0.1875", "0.5", "1", "4", "256"}) {
      const TechniqueSpec spec = parse_technique(std::string("ray_classification:min_rays=1,memory_mb=") + budget);
      const auto structure = spec.structure->build(scene, spec.params, 1);
      const test::Traced traced = test::trace(*structure, {best_isa(), packet, spec.params}, reference.rays);
      test::expect_same_hits(traced.hits, reference.list.hits, reference.rays);
      for (std::size_t i = 0; i < reference.rays.size(); ++i) ASSERT_EQ(traced.blockers[i] < 0, reference.list.blockers[i] < 0) << budget << ", ray " << i;
      EXPECT_LT(traced.closest.live(Event::prim_test), before) << budget;
      before = traced.closest.live(Event::prim_test);
    }
  }
}

/// A cap may lose the nearest hit, and then finds another one further away or none; it invents none.
TEST(RayClassification, CappedListsLoseHitsAndSaveTests) {
  const StructureEntry& entry = structure_entry("ray_classification");
  EXPECT_TRUE(answers_for_itself(entry, parse_technique("ray_classification:most_candidates=8").params));
  EXPECT_FALSE(answers_for_itself(entry, parse_technique("ray_classification:most_candidates=0").params));
  const Scene scene = load_scene("gen:terrain:2000");
  const test::Reference reference(scene, best_isa());
  const auto traced_with = [&](const char* cap) {
    const TechniqueSpec spec = parse_technique(std::string("ray_classification:most_candidates=") + cap);
    const auto structure = spec.structure->build(scene, spec.params, 1);
    return test::trace(*structure, {best_isa(), 16, spec.params}, reference.rays);
  };
  const test::Traced all = traced_with("0"), enough = traced_with("2000"), few = traced_with("4");
  test::expect_same_hits(all.hits, reference.list.hits, reference.rays);
  test::expect_same_hits(enough.hits, reference.list.hits, reference.rays);
  EXPECT_EQ(enough.closest.live(Event::prim_test), all.closest.live(Event::prim_test));
  EXPECT_LT(few.closest.live(Event::prim_test), all.closest.live(Event::prim_test));
  std::size_t lost = 0;
  for (std::size_t i = 0; i < reference.rays.size(); ++i) {
    EXPECT_GE(few.hits.t[i], all.hits.t[i]) << i;
    lost += few.hits.prim[i] != all.hits.prim[i] ? 1 : 0;
  }
  EXPECT_GT(lost, 0u);
}

TEST(RayClassification, TooSmallABudgetIsAnErrorThatNamesTheLeast) {
  const Scene scene = load_scene("gen:terrain:20000");
  const auto structure = structure_entry("ray_classification").build(scene, structure_entry("ray_classification").resolve({}), 1);
  const auto query = [&](const std::string& budget) {
    return structure->intersector({Isa::scalar, 1, parse_technique("ray_classification:memory_mb=" + budget).params});
  };
  try {
    (void)query("0.0625");
    FAIL() << "20000 primitives in 64 KiB";
  } catch (const Error& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.find("memory_mb: 0.0625 is too little"), 0u) << text;
    const std::size_t least = text.find("at least ");
    ASSERT_NE(least, std::string::npos) << text;
    EXPECT_NO_THROW((void)query(text.substr(least + 9)));
  }
}

TEST(RayClassification, CountsDependNeitherOnThreadsNorOnHistory) {
  const Scene& scene = test::scene_named("mixed");
  const RayBatch batch = adversarial_rays(scene, 20'000, 12), other = adversarial_rays(scene, 30'000, 13);
  for (const char* technique : {"ray_classification", "ray_classification:min_rays=1,memory_mb=0.0625"}) {
    const TechniqueSpec spec = parse_technique(technique);
    const auto structure = spec.structure->build(scene, spec.params, 1);
    const auto counts = [&](Intersector& tracer, const RayBatch& rays, int threads) {
      tracer.prepare(rays.view(), Query::closest, threads);
      HitBatch hits;
      Counters counters;
      trace_closest(tracer, rays, hits, threads, &counters);
      return counters;
    };
    const QueryOptions options{best_isa(), 64, spec.params};
    const Counters expected = counts(*structure->intersector(options), batch, 1);
    for (const int threads : {1, 2, 7}) {
      const auto tracer = structure->intersector(options);
      (void)counts(*tracer, other, threads);
      EXPECT_EQ(counts(*tracer, batch, threads), expected) << technique << ", " << threads << " threads";
      EXPECT_EQ(counts(*tracer, batch, threads), expected) << technique << ", steady, " << threads << " threads";
    }
  }
}

TEST(RayClassification, PacketsOfACellShareItsList) {
  const Scene& scene = test::scene_named("mixed");
  const RayBatch rays = test::coherent_rays(scene);
  const Isa isa = best_isa();
  if (simd_width(isa) == 1) GTEST_SKIP() << "a register of one lane shares nothing";
  const TechniqueSpec spec = parse_technique("ray_classification");
  const test::Traced traced = test::trace(*spec.structure->build(scene, spec.params, 1), {isa, kMaxPacket, spec.params}, rays);
  EXPECT_LT(traced.closest.executed(Event::leaf_visit) * 4, traced.closest.live(Event::leaf_visit));
  EXPECT_LT(traced.closest.executed(Event::prim_test) * 2, traced.closest.live(Event::prim_test));
}

/// The most that has been resident since reset(), what was only there while lists were made included.
class PeakMemory {
public:
  /// False where the system does not let a process do so.
  [[nodiscard]] static bool reset() { return static_cast<bool>(std::ofstream("/proc/self/clear_refs") << 5 << std::flush); }
  [[nodiscard]] static std::size_t bytes() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);) {
      if (line.starts_with("VmHWM:")) return std::stoull(line.substr(6)) * 1024;
    }
    return 0;
  }
};

/// The process grows by the budget and a tenth at most while cells of the batches, one after the other and all again, come and go. Budgets are to be large
/// enough for what the allocator keeps for each thread, about 2 MB, to be little of them.
void expect_resident_memory_within_budget(const Scene& scene, const std::string& memory_mb, std::span<const RayBatch> batches, int threads) {
  const TechniqueSpec spec = parse_technique("ray_classification:min_rays=1,leaf_size=1,memory_mb=" + memory_mb);
  const auto budget = static_cast<std::size_t>(std::stod(memory_mb) * 0x1p20);
  const auto structure = spec.structure->build(scene, spec.params, threads);
  const auto tracer = structure->intersector({best_isa(), 16, spec.params});
  const auto& cells = dynamic_cast<const OnDemand&>(*tracer);
  structure->intersector({best_isa(), 16, spec.params})->prepare(batches[0].view(), Query::closest, threads);  // starts what threads keep
  ::malloc_trim(0);                                                                                            // what is free but resident would hide growth
  if (!PeakMemory::reset()) GTEST_SKIP() << "the most that is resident cannot be reset here";
  const std::size_t before = PeakMemory::bytes();
  std::size_t most = 0, most_rays = 0;
  for (int round = 0; round < 2; ++round) {
    for (const RayBatch& rays : batches) {
      tracer->prepare(rays.view(), Query::closest, threads);
      most_rays = std::max(most_rays, rays.size());
      const std::size_t of_rays = most_rays * 32;  // keys, places and cells of rays, with room for sorting
      EXPECT_LE(PeakMemory::bytes(), before + of_rays + budget * 11 / 10) << "batch " << &rays - batches.data() << ", round " << round;
      EXPECT_LE(cells.demand().bytes, budget);
      most = std::max(most, cells.demand().bytes);
    }
  }
  EXPECT_GT(most, budget * 3 / 4) << "it is used";
  EXPECT_GT(PeakMemory::bytes(), before + budget / 2) << "and seen";
  testing::Test::RecordProperty("cells_bytes", std::to_string(most));
  testing::Test::RecordProperty("resident_growth", std::to_string(PeakMemory::bytes() - before));
}

TEST(RayClassification, ResidentMemoryStaysWithinATenthOfTheBudget) {
  const Scene scene = load_scene("gen:terrain:50000");
  std::vector<RayBatch> batches;
  for (std::uint64_t seed = 14; seed < 16; ++seed) batches.push_back(adversarial_rays(scene, 12000, seed));
  for (const int threads : {1, 2}) {
    SCOPED_TRACE(threads);
    expect_resident_memory_within_budget(scene, "64", batches, threads);
  }
}

/// Many cells with short lists, and then few with long ones that need the memory of all of them.
TEST(RayClassification, ResidentMemoryStaysWithinATenthOfTheBudgetWhereKindsOfBatchesAlternate) {
  test::Random random(15);
  const auto anywhere = [&] { return glm::dvec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)); };
  Scene scene;
  const auto add = [&](const glm::dvec3& a) {
    const glm::dvec3 b = a + 0.02 * random.direction(), c = a + 0.02 * random.direction();
    scene.add_triangle(glm::vec3(a), glm::vec3(b), glm::vec3(c));
  };
  for (int i = 0; i < 2000; ++i) add(anywhere());
  for (int i = 0; i < 1000; ++i) scene.add_triangle({0, 0, 0}, {0.01f, 0, 0.005f}, {0, 0.01f, 0.0025f});
  scene.finish();
  std::vector<RayBatch> batches(2);
  for (int i = 0; i < 30'000; ++i) batches[0].push_back(test::make_ray(anywhere(), random.direction()));
  for (int i = 0; i < 12'000; ++i) {
    const glm::dvec3 org = anywhere();
    batches[1].push_back(test::make_ray(org, glm::dvec3(0.003, 0.003, 0.002) - org));
  }
  expect_resident_memory_within_budget(scene, "64", batches, 1);
}

/// Lists of a class are a seventh of the least memory: they are made within it.
TEST(RayClassification, ResidentMemoryStaysWithinATenthOfTheLeastBudgetWhileListsAreMade) {
  const Scene scene = load_scene("gen:terrain:1000000");
  std::vector<RayBatch> batches;
  for (std::uint64_t seed = 18; seed < 20; ++seed) batches.push_back(adversarial_rays(scene, 2000, seed));
  for (const int threads : {1, 2}) {
    for (const char* memory_mb : {"60", "120"}) {
      SCOPED_TRACE(std::string(memory_mb) + " MB, threads " + std::to_string(threads));
      expect_resident_memory_within_budget(scene, memory_mb, batches, threads);
    }
  }
}

}  // namespace
}  // namespace raymeter
