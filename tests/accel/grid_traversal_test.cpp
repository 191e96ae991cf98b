#include <gtest/gtest.h>

#include <string>

#include "accel/grid/grid_build.h"
#include "core/geometry/error_bounds.h"
#include "tests/support/adversarial.h"
#include "tests/support/answer.h"
#include "tests/support/grid_rays.h"

namespace raymeter {
namespace {

using namespace test;

/// A sphere in each of two opposite corners spans the box [0, size]; whatever passes between them crosses empty cells only.
Scene hollow_scene(const glm::dvec3& size) {
  Scene scene;
  scene.add_sphere(glm::dvec3(0.001), 0.001);
  scene.add_sphere(size - 0.001, 0.001);
  scene.finish();
  return scene;
}

/// Counts the cells of each ray, traced alone.
class CellCounter {
public:
  CellCounter(const Scene& scene, const std::string& technique, Isa isa)
      : spec_(parse_technique(technique)),
        structure_(spec_.structure->build(scene, spec_.params, 1)),
        tracer_(structure_->intersector({isa, 1, spec_.params})) {
    hits_.resize(1);
  }
  Counters count(const RayBatch& rays, std::size_t i) {
    Counters counters;
    tracer_->closest_hit(rays.view(i, 1), hits_.view(), &counters, nullptr);
    return counters;
  }

private:
  TechniqueSpec spec_;
  std::unique_ptr<Structure> structure_;
  std::unique_ptr<Intersector> tracer_;
  HitBatch hits_;
};

struct CellBounds {
  std::uint64_t least = 0;  ///< cells with a chord of positive length
  std::uint64_t most = 0;   ///< and those that planes met at the same time, or at the ends, may add
};

/// When a ray is between two planes of an axis.
struct Interval {
  double enters = 0;
  double leaves = kInf;
};

Interval line_in(const GridFrame& frame, const Ray& r) {
  Interval line;
  for (std::size_t a = 0; a < 3; ++a) {
    const double o = double{r.org[a]}, d = double{r.dir[a]};
    const double low = double{frame.box[a]} - o, high = double{frame.box[a + 3]} - o;
    if (d == 0 && low <= 0 && high >= 0) continue;
    if (d == 0) return {0, -1};
    line.enters = std::max(line.enters, std::min(low / d, high / d));
    line.leaves = std::min(line.leaves, std::max(low / d, high / d));
  }
  return line;
}

/// The cells that a ray meets. Differences of floats of like size are exact in double and quotients correctly rounded, so that planes which a ray meets at the
/// same time get the same number. `slack` is the share of t by which the kernel's ends of the grid, and its crossings among each other, may be off.
CellBounds cells_on(const GridFrame& frame, const Ray& r, double slack) {
  const Interval line = line_in(frame, r);
  if (line.leaves < 0) return {};
  const bool grazes = line.enters * (1 + slack) >= line.leaves * (1 - slack);  // may be taken for a miss, or for a hit
  if (grazes && line.enters * (1 - slack) > line.leaves * (1 + slack)) return {};
  std::vector<double> crossings;
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::int32_t i = 1; i < frame.resolution[a] && r.dir[a] != 0; ++i) {
      const double t = (double{grid_plane(static_cast<float>(i), frame.cell_size[a], frame.origin[a])} - double{r.org[a]}) / double{r.dir[a]};
      if (t >= line.enters * (1 - slack) && t <= line.leaves * (1 + slack)) crossings.push_back(t);
    }
  }
  std::sort(crossings.begin(), crossings.end());
  CellBounds bounds{1, 1 + crossings.size()};
  double last = line.enters;
  for (const double t : crossings) {
    if (t > last * (1 + slack) && t < line.leaves * (1 - slack)) ++bounds.least;
    last = std::max(last, t);
  }
  if (grazes) bounds.least = 0;
  return bounds;
}

TEST(GridTraversal, VisitsTheCellsOfPositiveChordAndNoOthers) {
  const glm::dvec3 size(64, 32, 64);
  const Scene scene = hollow_scene(size);
  GridParams with;
  with.resolution = "64x32x64";
  const GridFrame frame = build_uniform_grid(scene, with, 1).frame;
  std::mt19937 random(7);
  RayBatch rays;
  for (int i = 0; i < 20000; ++i) {
    const glm::dvec3 from = size * (2.0 * point(random) - 0.5), to = size * point(random);
    glm::dvec3 dir = to - from;
    if (i % 4 == 0) dir[i / 4 % 3] = 0;
    rays.push_back(ray(from, dir));
  }
  for (const Isa isa : kIsas) {
    if (!available(isa)) continue;
    CellCounter counter(scene, "grid:resolution=" + with.resolution, isa);
    std::size_t exact = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Counters counters = counter.count(rays, i);
      if (counters.live(Event::prim_hit) > 0) continue;  // ended early
      // The box test's 16 roundings and the crossings' 3, of a distance that is up to three times that of the later end.
      const CellBounds bounds = cells_on(frame, rays[i], 64 * double{kUnitRoundoff});
      const std::uint64_t visits = counters.live(Event::node_visit);
      ASSERT_GE(visits, bounds.least) << name(isa) << " ray " << i;
      ASSERT_LE(visits, bounds.most) << name(isa) << " ray " << i;
      ASSERT_EQ(visits, counters.live(Event::leaf_visit));
      exact += bounds.least == bounds.most ? 1u : 0u;
    }
    EXPECT_GT(exact, rays.size() * 9 / 10) << "the bounds have become too wide to tell anything";
  }
}

TEST(GridTraversal, EndsWithinTheSumOfTheResolution) {
  // Rays on and beside planes, edges and corners, with zero, denormal and huge directions, no two the same.
  const RayBatch rays = lattice_rays(kAdversarialRays, 8);
  for (const Isa isa : {Isa::scalar, best_isa()}) {
    CellCounter counter(hollow_scene(glm::dvec3(8)), "grid:resolution=8x8x8", isa);
    std::uint64_t longest = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) longest = std::max(longest, counter.count(rays, i).live(Event::node_visit));
    EXPECT_EQ(longest, 8u + 8u + 8u - 2u) << name(isa);
  }
}

TEST(GridTraversal, CountsTheSameForSingleRaysOnEveryIsa) {
  const Scene scene = mixed_scene(2000, 0.1);
  const RayBatch rays = random_rays(2000);
  const Counters scalar = answer(scene, rays, "grid", Isa::scalar, 1).closest;
  for (const Isa isa : kIsas) {
    if (!available(isa)) continue;
    const Counters counters = answer(scene, rays, "grid", isa, 1).closest;
    // Instruction sets with FMA round otherwise: a ray that ends within a rounding of a plane, or touches a silhouette, may go a step further. One in 10^4.
    const double tolerance = isa == Isa::scalar || isa == Isa::sse42 ? 0 : 1e-4;
    for (const Event event : {Event::node_visit, Event::leaf_visit, Event::empty_leaf_visit, Event::prim_test}) {
      const auto expected = static_cast<double>(scalar.live(event));
      EXPECT_NEAR(static_cast<double>(counters.live(event)), expected, tolerance * expected) << name(isa);
      EXPECT_EQ(counters.live(event), counters.executed(event)) << name(isa);
    }
  }
}

TEST(GridTraversal, SharesStepsAndListsAmongCoherentRays) {
  const Scene scene = mixed_scene(2000, 0.1);
  RayBatch rays;
  for (int i = 0; i < 64 * 64; ++i) {  // tiles of 8 x 8 over a quarter of a face
    const int x = i % 8 + i / 64 % 8 * 8, y = i / 8 % 8 + i / 512 * 8;
    rays.push_back(ray({1.5, 2, 3}, glm::dvec3(x / 128.0, y / 128.0, 0.5) - glm::dvec3(1.5, 2, 3)));
  }
  for (const Isa isa : kIsas) {
    if (!available(isa) || simd_width(isa) == 1) continue;
    const Counters alone = answer(scene, rays, "grid", isa, 1).closest;
    for (const int packet : {simd_width(isa), 64}) {
      const Counters counters = answer(scene, rays, "grid", isa, packet).closest;
      const auto width = static_cast<std::uint64_t>(simd_width(isa));
      // Half of the lanes at work in steps, a quarter in tests, where no more than the cells' size against the rays' distance stands in the way.
      EXPECT_LT(counters.executed(Event::node_visit) * width, counters.live(Event::node_visit) * 2) << name(isa) << " packet " << packet;
      EXPECT_LT(counters.executed(Event::prim_test) * width, counters.live(Event::prim_test) * 4) << name(isa) << " packet " << packet;
      // Never further than alone: what a ray's neighbours test can only bring its end nearer.
      EXPECT_LE(counters.live(Event::node_visit), alone.live(Event::node_visit)) << name(isa) << " packet " << packet;
    }
  }
}

TEST(GridTraversal, TestsNoPrimitiveTwiceForARay) {
  Scene scene;
  for (int i = 0; i < 50; ++i) scene.add_triangle({0, 0, 0}, {16, 0, 0}, {0, 16, 16});  // its box is the grid's, but it lies where x + y <= 16
  scene.finish();
  RayBatch rays;
  std::mt19937 random(8);
  for (int i = 0; i < 1000; ++i) rays.push_back(ray({15 + uniform(random), -1, 2 + 12 * uniform(random)}, {0, 1, 0.1 * uniform(random)}));
  for (const int packet : {1, 64}) {
    const Counters on = answer(scene, rays, "grid:resolution=16x16x16", best_isa(), packet).closest;
    const Counters off = answer(scene, rays, "grid:resolution=16x16x16,mailbox=off", best_isa(), packet).closest;
    EXPECT_EQ(on.live(Event::prim_test), 50u * rays.size()) << packet;
    EXPECT_EQ(off.live(Event::prim_test), 50u * off.live(Event::node_visit)) << packet;
    EXPECT_EQ(on.live(Event::node_visit), off.live(Event::node_visit)) << packet;
  }
}

}  // namespace
}  // namespace raymeter
