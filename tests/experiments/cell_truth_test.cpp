// The cells that rays pass through, against every cell's own rational arithmetic.

#include "experiments/verify/cell_truth.h"

#include <algorithm>
#include <optional>
#include <random>

#include <gmpxx.h>
#include <gtest/gtest.h>

#include "tests/support/grid_rays.h"

namespace raymeter {
namespace {

using test::lattice_rays;
using test::uniform;

/// The ray's way through the interior of a cell: its beginning and end, empty where there is none.
std::optional<std::array<mpq_class, 2>> way_in(const CellWalk::Cells& cells, const Ray& ray, const std::array<std::size_t, 3>& at) {
  std::optional<mpq_class> begin, end;
  const auto from = [&](const mpq_class& t) { begin = begin && *begin > t ? *begin : t; };
  const auto to = [&](const mpq_class& t) { end = end && *end < t ? *end : t; };
  if (std::isfinite(ray.t_min)) from(mpq_class(double{ray.t_min}));
  if (std::isfinite(ray.t_max)) to(mpq_class(double{ray.t_max}));
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<glm::length_t>(a);
    const bool first = at[a] == 0, last = at[a] == cells.planes[a].size();
    const float low = first ? cells.box.min[axis] : std::max(cells.box.min[axis], cells.planes[a][at[a] - 1]);
    const float high = last ? cells.box.max[axis] : std::min(cells.box.max[axis], cells.planes[a][at[a]]);
    const mpq_class org(double{ray.org[a]}), dir(double{ray.dir[a]}), below(double{low}), above(double{high});
    if (dir == 0) {
      if (first ? org < below : org <= below) return {};
      if (last ? org > above : org >= above) return {};
      continue;
    }
    from(((dir > 0 ? below : above) - org) / dir);
    to(((dir > 0 ? above : below) - org) / dir);
  }
  if (!begin || !end || *begin >= *end) return {};
  return std::array{*begin, *end};
}

void expect_cells_of(const CellWalk::Cells& cells, const RayBatch& rays) {
  std::size_t passed_at_all = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Ray ray = rays[i];
    std::vector<PassedCell> passed = cells_passed(cells, ray);
    std::size_t found = 0;
    std::int32_t cell = 0;
    for (std::size_t z = 0; z < cells.resolution(2); ++z) {
      for (std::size_t y = 0; y < cells.resolution(1); ++y) {
        for (std::size_t x = 0; x < cells.resolution(0); ++x, ++cell) {
          const auto way = way_in(cells, ray, {x, y, z});
          const auto one = std::ranges::find(passed, cell, &PassedCell::cell);
          ASSERT_EQ(way.has_value(), one != passed.end()) << "ray " << i << " cell " << x << ' ' << y << ' ' << z;
          if (!way) continue;
          ++found;
          const mpq_class length = ((*way)[1] - (*way)[0]) * abs(mpq_class(double{ray.dir[0]}));
          EXPECT_NEAR(one->way[0], length.get_d(), 1e-9 * (1 + std::abs((*way)[1].get_d() * double{ray.dir[0]}))) << "ray " << i;
        }
      }
    }
    ASSERT_EQ(found, passed.size()) << "ray " << i;
    passed_at_all += passed.empty() ? 0 : 1;
  }
  EXPECT_GT(passed_at_all, rays.size() / 20);
}

CellWalk::Cells unit_cells(int n) {
  CellWalk::Cells cells{{}, {1, 1, 1}, {0, 0, 0}, {}};
  for (std::size_t a = 0; a < 3; ++a) {
    for (int i = 1; i < n; ++i) cells.planes[a].push_back(static_cast<float>(i));
  }
  cells.box.min = glm::vec3(0);
  cells.box.max = glm::vec3(static_cast<float>(n));
  return cells;
}

TEST(CellTruth, IsThatOfEveryCellOnPlanesEdgesAndCorners) { expect_cells_of(unit_cells(4), lattice_rays(1500, 4)); }

TEST(CellTruth, IsThatOfEveryCellAtRandom) {
  CellWalk::Cells cells = unit_cells(1);
  std::mt19937 random(4);
  cells.box.max = glm::vec3(1);
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t i = 0; i < 3 + a; ++i) cells.planes[a].push_back(static_cast<float>(uniform(random)));
    std::ranges::sort(cells.planes[a]);
  }
  expect_cells_of(cells, test::random_rays(1000));
}

TEST(CellTruth, KnowsNoCellsOfInvalidRays) {
  const CellWalk::Cells cells = unit_cells(4);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const Ray& bad : {Ray{{nan, 1, 1}, 0, {1, 0, 0}, 9}, Ray{{0, 1, 1}, 0, {0, 0, -0.0f}, 9}, Ray{{0, 0.5f, 0.5f}, 2, {1, 0, 0}, 1},
                         Ray{{0, 0.5f, 0.5f}, nan, {1, 0, 0}, 1}, Ray{{0, 0.5f, 0.5f}, 0, {test::kInf, 0, 0}, 1}}) {
    EXPECT_TRUE(cells_passed(cells, bad).empty());
  }
  EXPECT_EQ(cells_passed(cells, {{0, 0.5f, 0.5f}, 0, {1, 0, 0}, 9}).size(), 4u);
}

}  // namespace
}  // namespace raymeter
