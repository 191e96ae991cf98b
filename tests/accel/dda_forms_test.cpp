// The forms of the grid's DDA: what they answer, and the cells through which they lead.

#include <string>

#include <gtest/gtest.h>

#include "accel/grid/grid.h"
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

/// How far a ray may go at most in a cell that it misses, in cells, if crossings T are good to `roundings` of their exact times t. Spans of T cover the ray's
/// way (grid_walk_kernel.h, 2), and T does not decrease along an axis: the cell is missed only if the largest T of its entries is no less than the smallest T
/// of its exits, so that its span [t1, t2] has t2 - t1 <= roundings u (t1 + t2), times |dir| at most 2 roundings u |P - org|. The last factor: what their own
/// products add.
double longest_missed(const CellWalk::Cells& cells, const RayBatch& rays, int roundings) {
  double furthest = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    for (std::size_t a = 0; a < 3; ++a) {
      if (cells.planes[a].empty()) continue;
      const double org{rays[i].org[a]}, low{cells.box.min[static_cast<glm::length_t>(a)]}, high{cells.box.max[static_cast<glm::length_t>(a)]};
      furthest = std::max(furthest, std::max(std::abs(low - org), std::abs(high - org)) / cells.cell_size[a]);
    }
  }
  return 2 * roundings * 0x1p-24 * furthest * (1 + 0x1p-20);
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

/// None of these is proven to find all, but on these rays, the same on every machine, lists reach further than they err.
TEST(DdaForms, EndOnAnyRayAndLoseNoneOfTheseHits) {
  const Scene scene = mixed_scene(300, 0.2);
  RayBatch rays = lattice_rays(3000, 1);
  const RayBatch random = random_rays(1000);
  for (std::size_t i = 0; i < random.size(); ++i) rays.push_back(random[i]);
  for (const Isa isa : kIsas) {
    if (!available(isa)) continue;
    const Answer list = answer(scene, rays, "list", isa, 16);
    for (const std::string_view form : {"fma", "accumulate", "compensated"}) {
      SCOPED_TRACE(std::string(form) + ' ' + std::string(name(isa)));
      expect_same_hits(answer(scene, rays, grid(form, "64x64x64"), isa, 16).hits, list.hits, rays);
    }
  }
}

TEST(DdaForms, AreWeakSettingsButForTheDefault) {
  const auto weak = [](std::string_view text) {
    const TechniqueSpec technique = parse_technique(text);
    return answers_for_itself(*technique.structure, technique.params);
  };
  EXPECT_FALSE(weak("grid"));
  for (const auto& [form, which] : kDdaForms) EXPECT_EQ(weak("grid:dda=" + std::string(form)), which != DdaForm::recompute) << form;
  EXPECT_THROW((void)parse_technique("grid:traversal=slices,dda=divide"), Error);
}

TEST(CellWalk, ShowsTheCellsThatTracedRaysVisit) {
  const Problem problem = hard_case("cells_across").make(2000, 3);
  for (const auto& [form, which] : kDdaForms) {
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
      for (const auto& [form, roundings] : {std::pair{"recompute", 3}, std::pair{"divide", 2}}) {
        for (const Isa isa : kIsas) {
          if (!available(isa)) continue;
          SCOPED_TRACE(std::string(name) + ' ' + std::string(resolution) + ' ' + form + ' ' + std::string(raymeter::name(isa)));
          const Built built(problem.scene, grid(form, resolution), isa);
          const CellAccuracy found = verify_cells(built.walk(), problem.set.rays, kAll);
          EXPECT_EQ(found.rays_checked, 1000);
          EXPECT_EQ(found.rays_at_risk, 0);
          EXPECT_LE(found.longest, longest_missed(built.walk().cells(), problem.set.rays, roundings));
        }
      }
    }
  }
}

/// Numerics case 37 at its longest: thousands of steps a ray.
TEST(CellWalk, OfThousandsOfCellsMissesNoneForLongerThanListsReach) {
  for (const std::string_view name : kCases) {
    const Problem problem = hard_case(name).make(700, 6);
    for (const Isa isa : kIsas) {
      if (!available(isa)) continue;
      SCOPED_TRACE(std::string(name) + ' ' + std::string(raymeter::name(isa)));
      const Built built(problem.scene, grid("recompute", "4096x4x1"), isa);
      const CellAccuracy found = verify_cells(built.walk(), problem.set.rays, kAll);
      EXPECT_EQ(found.rays_checked, 700);
      EXPECT_EQ(found.rays_at_risk, 0);
      EXPECT_LE(found.longest, longest_missed(built.walk().cells(), problem.set.rays, 3));
    }
  }
}

TEST(CellWalk, DriftsWhereStepsAreAddedUpUnlessTheirLossIsKept) {
  const Problem problem = hard_case("cells_across").make(1000, 5);
  for (const Isa isa : kIsas) {
    if (!available(isa)) continue;
    SCOPED_TRACE(name(isa));
    const CellAccuracy exact = accuracy(problem, "recompute", "1024x1024x4", isa), drift = accuracy(problem, "accumulate", "1024x1024x4", isa),
                       kept = accuracy(problem, "compensated", "1024x1024x4", isa);
    // Further than three roundings could lead it, and within them.
    const double by_index = longest_missed(Built(problem.scene, grid("recompute", "1024x1024x4"), isa).walk().cells(), problem.set.rays, 3);
    EXPECT_GT(drift.longest, by_index);
    EXPECT_LE(kept.longest, by_index);
    EXPECT_GT(drift.rays_missing, exact.rays_missing);
    EXPECT_GT(drift.longest, accuracy(problem, "accumulate", "64x64x1", isa).longest);
  }
}

}  // namespace
}  // namespace raymeter
