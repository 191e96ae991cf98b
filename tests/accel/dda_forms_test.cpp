// The forms of the grid's DDA: what they answer, and the cells through which they lead.

#include <string>

#include <gtest/gtest.h>

#include "accel/weak_settings.h"
#include "core/trace/cell_walk.h"
#include "experiments/cases/hard_case.h"
#include "experiments/verify/cell_truth.h"
#include "tests/support/answer.h"
#include "tests/support/grid_rays.h"
#include "tests/support/traces.h"

namespace raymeter {
namespace {

using namespace test;

constexpr std::array<std::string_view, 5> kForms{"recompute", "divide", "fma", "accumulate", "compensated"};
constexpr std::array<std::string_view, 3> kCases{"cells_across", "cell_corners", "cell_rows"};
constexpr OracleBudget kAll{1e12, 1, 1};

std::string grid(std::string_view form, std::string_view resolution) { return "grid:dda=" + std::string(form) + ",resolution=" + std::string(resolution); }

/// A built grid and its intersector by one form.
struct Built {
  std::unique_ptr<Structure> structure;
  std::unique_ptr<Intersector> intersector;

  Built(const Scene& scene, const std::string& text, Isa isa, int packet = 16) {
    const TechniqueSpec technique = parse_technique(text);
    structure = technique.structure->build(scene, technique.params, 1);
    intersector = structure->intersector({isa, packet, technique.params});
  }
  [[nodiscard]] const CellWalk& walk() const { return dynamic_cast<const CellWalk&>(*intersector); }
};

CellAccuracy accuracy(const Problem& problem, std::string_view form, std::string_view resolution, Isa isa) {
  return verify_cells(Built(problem.scene, grid(form, resolution), isa).walk(), problem.set.rays, kAll);
}

TEST(DdaForms, FromThePlanesIndexAnswerAsTheList) {
  const Scene scene = mixed_scene(300, 0.2);
  RayBatch rays = random_rays(600);
  const RayBatch lattice = lattice_rays(600, 1);
  for (std::size_t i = 0; i < lattice.size(); ++i) rays.push_back(lattice[i]);
  for (const Isa isa : kIsas) {
    if (!available(isa)) continue;
    for (const int packet : {1, 16, 64}) {
      SCOPED_TRACE(std::string(name(isa)) + " packet " + std::to_string(packet));
      const Answer list = answer(scene, rays, "list", isa, packet), divided = answer(scene, rays, grid("divide", "24x16x20"), isa, packet);
      expect_same_hits(divided.hits, list.hits, rays);
      for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_EQ(divided.blocker[i] >= 0, list.hits.prim[i] >= 0) << "ray " << i;
    }
  }
}

TEST(DdaForms, EndOnAnyRayAndHardlyLoseAHit) {
  const Scene scene = mixed_scene(300, 0.2);
  RayBatch rays = lattice_rays(3000, 1);
  const RayBatch random = random_rays(1000);
  for (std::size_t i = 0; i < random.size(); ++i) rays.push_back(random[i]);
  for (const Isa isa : kIsas) {
    if (!available(isa)) continue;
    const Answer list = answer(scene, rays, "list", isa, 16);
    for (const std::string_view form : {"fma", "accumulate", "compensated"}) {
      const Answer found = answer(scene, rays, grid(form, "64x64x64"), isa, 16);
      std::size_t others = 0;
      for (std::size_t i = 0; i < rays.size(); ++i) others += found.hits.prim[i] != list.hits.prim[i] ? 1 : 0;
      EXPECT_LE(others, rays.size() / 100) << form << ' ' << name(isa);
    }
  }
}

TEST(DdaForms, AreWeakSettingsButForTheDefault) {
  const auto weak = [](std::string_view text) {
    const TechniqueSpec technique = parse_technique(text);
    return answers_for_itself(*technique.structure, technique.params);
  };
  EXPECT_FALSE(weak("grid"));
  for (const std::string_view form : kForms) EXPECT_EQ(weak("grid:dda=" + std::string(form)), form != "recompute") << form;
  EXPECT_THROW((void)parse_technique("grid:traversal=slices,dda=divide"), Error);
}

TEST(CellWalk, ShowsTheCellsThatTracedRaysVisit) {
  const Problem problem = hard_case("cells_across").make(2000, 3);
  for (const std::string_view form : kForms) {
    for (const Isa isa : kIsas) {
      if (!available(isa)) continue;
      const Built built(problem.scene, grid(form, "100x90x3"), isa, 1);
      HitBatch hits;
      trace_closest(*built.intersector, problem.set.rays, hits, 1);
      RayBatch passing;
      for (std::size_t i = 0; i < hits.prim.size(); ++i) {
        if (hits.prim[i] < 0) passing.push_back(problem.set.rays[i]);
      }
      ASSERT_GT(passing.size(), 500u);
      Counters counters;
      trace_closest(*built.intersector, passing, hits, 1, &counters);
      std::vector<std::int32_t> visited(passing.size() * built.walk().cells().most()), count(passing.size());
      built.walk().walk(passing.view(), visited.data(), count.data());
      std::uint64_t sum = 0;
      for (const std::int32_t cells : count) sum += static_cast<std::uint64_t>(cells);
      EXPECT_EQ(sum, counters.live(Event::node_visit)) << form << ' ' << name(isa);
    }
  }
}

TEST(CellWalk, OfRaysThatAreTestedAgainstEverythingIsNone) {
  const Built built(mixed_scene(300, 0.2), grid("recompute", "16x16x16"), Isa::scalar);
  RayBatch rays = random_rays(1);
  rays.push_back(ray({1e30, 0, 0}, {-1, 0, 0}));
  rays.push_back(ray({5, 5, 5}, {1, 0, 0}));
  std::vector<std::int32_t> visited(3 * built.walk().cells().most()), count(3);
  built.walk().walk(rays.view(), visited.data(), count.data());
  EXPECT_EQ(count[1], CellWalk::kEverywhere);
  EXPECT_EQ(count[2], 0);
}

TEST(CellWalk, FromThePlanesIndexMissesNoCellForLongerThanListsReach) {
  for (const std::string_view name : kCases) {
    const Problem problem = hard_case(name).make(1000, 5);
    for (const std::string_view resolution : {"16x16x1", "61x67x5", "512x512x8"}) {
      for (const std::string_view form : {"recompute", "divide"}) {
        for (const Isa isa : kIsas) {
          if (!available(isa)) continue;
          const CellAccuracy found = accuracy(problem, form, resolution, isa);
          EXPECT_EQ(found.rays_checked, 1000) << name;
          EXPECT_EQ(found.rays_at_risk, 0) << name << ' ' << resolution << ' ' << form << ' ' << raymeter::name(isa);
          EXPECT_LT(found.longest, 1e-3) << name << ' ' << resolution << ' ' << form << ' ' << raymeter::name(isa);
        }
      }
    }
  }
}

TEST(CellWalk, DriftsWhereStepsAreAddedUpUnlessTheirLossIsKept) {
  const Problem problem = hard_case("cells_across").make(1000, 5);
  for (const Isa isa : kIsas) {
    if (!available(isa)) continue;
    const CellAccuracy exact = accuracy(problem, "recompute", "1024x1024x4", isa), drift = accuracy(problem, "accumulate", "1024x1024x4", isa),
                       kept = accuracy(problem, "compensated", "1024x1024x4", isa);
    EXPECT_GT(drift.longest, 8 * exact.longest) << name(isa);
    EXPECT_GT(drift.rays_missing, 2 * exact.rays_missing) << name(isa);
    EXPECT_LT(kept.longest, 4 * exact.longest) << name(isa);
    EXPECT_GT(drift.longest, 8 * accuracy(problem, "accumulate", "64x64x1", isa).longest) << name(isa);
  }
}

}  // namespace
}  // namespace raymeter
