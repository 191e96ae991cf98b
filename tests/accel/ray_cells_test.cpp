// The cells of ray classification by themselves: what they list, which serve a batch, what is kept.

#include <algorithm>
#include <bit>
#include <numeric>
#include <set>

#include <gtest/gtest.h>

#include "accel/ray_classification/classify_kernel.h"
#include "accel/ray_classification/ray_cells.h"
#include "core/base/threads.h"
#include "experiments/scenes/scene_source.h"
#include "tests/support/random.h"
#include "tests/support/test_rays.h"
#include "tests/support/traces.h"

namespace raymeter {
namespace {

RayClassificationParams params_with(double memory_mb, int min_rays = 1) {
  RayClassificationParams params;
  params.memory_mb = memory_mb;
  params.min_rays = min_rays;
  return params;
}

RayOrder ordered(const ClassifiedScene& scene, const RayBatch& rays, int threads = 1) {
  RayOrder order;
  order.reset(rays.size());
  ClassifyKernel<Isa::scalar>::keys(scene.space.frame(), rays.view(), 0, static_cast<std::int32_t>(rays.size()), order.key.data());
  order.sort(scene.space.key_bits() + 3, threads);
  return order;
}

void serve(RayCells& cells, const RayOrder& rays, int threads = 1) {
  on_threads(threads, [&] { cells.serve(rays); });
}

/// The ids of what each ray's cell lists, in the order of the batch.
std::vector<std::set<std::int32_t>> candidates_of(const ClassifiedScene& scene, const RayCells& cells, const RayOrder& rays) {
  std::vector<std::set<std::int32_t>> out(rays.place.size());
  std::vector<std::set<std::int32_t>> of_cell;
  for (const RayCell& cell : cells.cells()) {
    std::set<std::int32_t>& ids = of_cell.emplace_back();
    if (cell.ray_class == kUnclassified) {
      for (const PrimRef prim : scene.prims) ids.insert(scene.pools.prim_id(prim));
    } else if (cell.ray_class != kNowhere) {
      for (std::int32_t k = 0; k < cell.count; ++k) {
        const Candidate candidate = cell.list[k];
        ids.insert(scene.pools.prim_id(prim_ref(static_cast<PrimKind>(candidate.kind()), static_cast<std::size_t>(candidate.index()))));
      }
    }
  }
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[static_cast<std::size_t>(rays.place[i])] = of_cell[static_cast<std::size_t>(cells.cell_of_rays()[i])];
  }
  return out;
}

/// Which list, by content, each ray of the batch gets.
std::vector<std::vector<std::pair<float, std::uint32_t>>> lists_of(const RayCells& cells) {
  std::vector<std::vector<std::pair<float, std::uint32_t>>> out;
  for (const std::int32_t number : cells.cell_of_rays()) {
    const RayCell& cell = cells.cells()[static_cast<std::size_t>(number)];
    auto& list = out.emplace_back();
    for (std::int32_t k = 0; cell.list != nullptr && k < cell.count; ++k) list.emplace_back(cell.list[k].start, cell.list[k].ref);
  }
  return out;
}

RayBatch random_rays(const ClassifiedScene& scene, std::size_t count, std::uint64_t seed) {
  test::Random random(seed);
  const RayClassFrame frame = scene.space.frame();
  RayBatch rays;
  for (std::size_t i = 0; i < count; ++i) {
    glm::dvec3 org;
    for (glm::length_t a = 0; a < 3; ++a) org[a] = random.uniform(double{frame.box[a]}, double{frame.box[a + 3]});
    rays.push_back(test::make_ray(org, random.direction()));
  }
  return rays;
}

TEST(RayOrder, SortsAsAStableSortDoesOnAnyNumberOfThreads) {
  test::Random random(1);
  constexpr std::size_t kRays = 200'001;
  Column<std::uint64_t> keys(kRays);
  for (std::uint64_t& key : keys) key = (random.below(1000) << 40) | (random.below(3) << 20) | random.below(5);
  std::vector<std::int32_t> expected(kRays);
  std::iota(expected.begin(), expected.end(), 0);
  std::ranges::stable_sort(expected, {}, [&](std::int32_t i) { return keys[static_cast<std::size_t>(i)]; });
  for (const int threads : {1, 2, 7}) {
    RayOrder order;
    order.reset(kRays);
    std::ranges::copy(keys, order.key.begin());
    order.sort(59, threads);
    EXPECT_TRUE(std::ranges::equal(order.place, expected)) << threads;
    EXPECT_TRUE(std::ranges::is_sorted(order.key)) << threads;
  }
}

TEST(RayCells, ListEverythingThatTheirRaysHit) {
  for (const Scene& scene : test::scenes()) {
    if (scene.prim_count() == 0) continue;
    const test::Reference reference(scene, Isa::scalar);
    const RayClassificationParams params = params_with(1024);
    const ClassifiedScene classified(scene, params, 1);
    const RayOrder order = ordered(classified, reference.rays);
    RayCells cells(classified, params);
    serve(cells, order);
    const auto candidates = candidates_of(classified, cells, order);
    std::size_t lost = 0;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      const auto has = [&](std::int32_t prim) { return prim < 0 || candidates[i].contains(prim); };
      lost += has(reference.list.hits.prim[i]) && has(reference.list.blockers[i]) ? 0 : 1;
    }
    EXPECT_EQ(lost, 0u) << scene.name;
  }
}

TEST(RayCells, AreSplitUntilTheirListsAreShort) {
  const Scene scene = load_scene("gen:terrain:2000");
  RayClassificationParams params = params_with(1024);
  params.max_depth = 56;
  params.position_bits = params.direction_bits = 12;
  const ClassifiedScene classified(scene, params, 1);
  const RayOrder order = ordered(classified, random_rays(classified, 2000, 3));
  RayCells cells(classified, params);
  serve(cells, order);
  std::int64_t longest = 0;
  for (const std::int32_t cell : cells.cell_of_rays()) longest = std::max<std::int64_t>(longest, cells.cells()[static_cast<std::size_t>(cell)].count);
  EXPECT_LE(longest, 40) << "of 2000";
  EXPECT_LE(static_cast<double>(cells.stats().candidates), 8.5 * static_cast<double>(cells.stats().cells)) << "leaf_size is 8";
}

TEST(RayCells, ListsAscendAlongTheDirection) {
  const Scene& scene = test::scene_named("mixed");
  const RayClassificationParams params = params_with(1024);
  const ClassifiedScene classified(scene, params, 1);
  const RayOrder order = ordered(classified, random_rays(classified, 5000, 4));
  RayCells cells(classified, params);
  serve(cells, order);
  for (const RayCell& cell : cells.cells()) {
    if (cell.list == nullptr) continue;
    EXPECT_TRUE(std::is_sorted(cell.list, cell.list + cell.count, [](Candidate a, Candidate b) { return a.start < b.start; }));
  }
}

TEST(RayCells, DoNotDependOnThreadsNorOnWhatWasTracedBefore) {
  const Scene scene = load_scene("gen:terrain:2000");
  for (const double memory_mb : {1024.0, 1.0, 0.375}) {
    const RayClassificationParams params = params_with(memory_mb, 4);
    const ClassifiedScene classified(scene, params, 1);
    const RayOrder batch = ordered(classified, random_rays(classified, 4000, 5)), other = ordered(classified, random_rays(classified, 6000, 6));
    RayCells fresh(classified, params);
    serve(fresh, batch);
    const auto expected = lists_of(fresh);
    const DemandStats stats = fresh.stats();
    serve(fresh, batch);
    EXPECT_EQ(lists_of(fresh), expected) << "the steady pass, " << memory_mb;
    for (const int threads : {1, 2, 7}) {
      RayCells used(classified, params);
      for (int round = 0; round < 2; ++round) {
        serve(used, other, threads);
        serve(used, batch, threads);
        EXPECT_EQ(lists_of(used), expected) << threads << " threads, " << memory_mb;
        EXPECT_EQ(used.stats().cells, stats.cells);
        EXPECT_EQ(used.stats().candidates, stats.candidates);
      }
    }
  }
}

TEST(RayCells, StayInsideTheirBudgetAndListLessWhereItIsLarger) {
  const Scene scene = load_scene("gen:terrain:2000");
  std::vector<double> per_ray;
  for (const double memory_mb : {0.25, 0.5, 1.0, 2.0, 4.0, 64.0}) {
    const RayClassificationParams params = params_with(memory_mb);
    const ClassifiedScene classified(scene, params, 1);
    RayCells cells(classified, params);
    for (const std::uint64_t seed : {7, 8, 9, 7}) {
      const RayOrder order = ordered(classified, random_rays(classified, 4000, seed));
      serve(cells, order, 2);
      EXPECT_LE(static_cast<double>(cells.stats().bytes), memory_mb * 0x1p20);
      if (seed != 7) continue;
      double candidates = 0;
      for (const std::int32_t cell : cells.cell_of_rays()) candidates += cells.cells()[static_cast<std::size_t>(cell)].count;
      per_ray.push_back(candidates);
    }
  }
  for (std::size_t i = 0; i + 2 < per_ray.size(); i += 2) {
    EXPECT_EQ(per_ray[i], per_ray[i + 1]) << "the same batch again";
    EXPECT_LT(per_ray[i + 2], per_ray[i]) << i / 2;
  }
}

/// To the byte: all objects lie in one place, so that cells take what was foreseen for them and not less, in batches of one class after batches of all.
TEST(RayCells, NeverTakeMoreThanTheirBudget) {
  Scene scene;
  for (int i = 0; i < 20; ++i) scene.add_triangle({0, 0, 0}, {1, 0, 0.5}, {0, 1, 0.25});
  scene.finish();
  for (int budget = 0; budget < 32; ++budget) {
    RayClassificationParams params = params_with((65536 + 16 * budget) * 0x1p-20);
    params.leaf_size = 1;
    const ClassifiedScene classified(scene, params, 1);
    const RayBatch all = random_rays(classified, 20000, 6);
    RayBatch one;
    for (std::size_t i = 0; i < all.size(); ++i) {
      Ray ray = all[i];
      ray.dir[0] = 2;  // others are at most 1
      one.push_back(ray);
    }
    RayCells cells(classified, params);
    for (const RayBatch* rays : {&all, static_cast<const RayBatch*>(&one), &all}) serve(cells, ordered(classified, *rays));
    EXPECT_LE(cells.most_bytes(), static_cast<std::size_t>(params.memory_mb * 0x1p20));
    EXPECT_GT(cells.most_bytes(), std::size_t{59500}) << "it is used, but for a 64th in which lists are made and a 16th for what lies free";
  }
}

TEST(RayCells, SplittingEndsWhereItHelpsNothing) {
  Scene scene;
  for (int i = 0; i < 1000; ++i) scene.add_triangle({0, 0, 0}, {1, 0, 0.5}, {0, 1, 0.25});
  scene.finish();
  const RayClassificationParams params = params_with(1024);
  const ClassifiedScene classified(scene, params, 1);
  const RayOrder order = ordered(classified, random_rays(classified, 2000, 10));
  RayCells cells(classified, params);
  serve(cells, order);
  // Every list holds all or none: what remains is splitting until none is held.
  for (const RayCell& cell : cells.cells()) EXPECT_TRUE(cell.count == 0 || cell.count == 1000);
  EXPECT_LE(cells.stats().bytes, std::size_t{1} << 28);
}

}  // namespace
}  // namespace raymeter
