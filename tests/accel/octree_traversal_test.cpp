#include <gtest/gtest.h>

#include <set>
#include <string>

#include "accel/kernel_set.h"
#include "accel/octree/octree_parametric_kernel.h"
#include "accel/octree/octree_scratch_layout.h"
#include "accel/octree/octree_tree.h"
#include "accel/octree/octree_walk_kernel.h"
#include "core/geometry/error_bounds.h"
#include "tests/support/adversarial.h"
#include "tests/support/answer.h"
#include "tests/support/grid_rays.h"
#include "tests/support/test_rays.h"

namespace raymeter {
namespace {

using namespace test;

enum class Tracking { parametric, point_location, neighbour };
constexpr Tracking kTrackings[] = {Tracking::parametric, Tracking::point_location, Tracking::neighbour};

const char* name_of(Tracking tracking) {
  return tracking == Tracking::parametric ? "parametric" : tracking == Tracking::point_location ? "point_location" : "neighbour";
}

/// A tree without lists, so that rays cross all of it, and its kernels.
class BareTree {
public:
  explicit BareTree(const Octree& tree) : tree_(tree), nodes_(tree.nodes), scratch_(OctreeScratch::bytes(20)) {
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      for (int c = 0; c < 8; ++c) {
        std::int32_t& link = nodes_[i].child[c];
        if (link >= 0) continue;
        link = ~0;
        leaves_.push_back(&link);
      }
    }
    hits_.resize(1);
  }
  [[nodiscard]] std::size_t leaf_count() const noexcept { return leaves_.size(); }

  Counters trace(const RayBatch& rays, std::size_t i, Tracking tracking, Isa isa) {
    OctreeView view = tree_.view({});
    view.nodes = nodes_.data();
    view.first = kNothing.data();
    view.neighbour = tracking == Tracking::neighbour;
    const auto& kernels =
        tracking == Tracking::parametric ? kernels_for<OctreeParametricKernel, OctreeView>(isa) : kernels_for<OctreeWalkKernel, OctreeView>(isa);
    Counters counters;
    kernels.counted_closest(view, {rays.view(i, 1), hits_.view(), nullptr, 1, scratch_.data()}, &counters);
    return counters;
  }

  /// Whether the ray visits a leaf: the only one that is not the empty one.
  bool visits(const RayBatch& rays, std::size_t i, Tracking tracking, Isa isa, std::size_t leaf) {
    *leaves_[leaf] = ~1;
    const Counters counters = trace(rays, i, tracking, isa);
    *leaves_[leaf] = ~0;
    const std::uint64_t visits = counters.live(Event::leaf_visit) - counters.live(Event::empty_leaf_visit);
    EXPECT_LE(visits, 1u);
    return visits > 0;
  }

private:
  static constexpr std::array<std::int32_t, 2 * kPrimKindCount + 1> kNothing{};
  const Octree& tree_;
  Column<OctreeNode> nodes_;
  std::vector<std::int32_t*> leaves_;
  Column<std::byte> scratch_;
  HitBatch hits_;
};

/// The leaves' cells, in the order of BareTree; infinite at the root's border.
std::vector<std::array<float, 6>> leaf_cells(const Octree& tree) {
  std::vector<std::array<float, 6>> cells;
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    for (int c = 0; c < 8; ++c) {
      if (tree.nodes[i].child[c] >= 0) continue;
      std::array<float, 6> cell{};
      for (std::size_t a = 0; a < 3; ++a) {
        const bool above = (c >> a & 1) != 0;
        cell[a] = above ? tree.nodes[i].split[a] : tree.outline[6 * i + a];
        cell[a + 3] = above ? tree.outline[6 * i + a + 3] : tree.nodes[i].split[a];
      }
      cells.push_back(cell);
    }
  }
  return cells;
}

/// The part of a ray in a box, in units of t; negative where it passes it by. Differences of floats of like size are exact in double.
struct Chord {
  double enters = 0, leaves = kInf;
  bool misses = false;
  void clip(const float* box, const Ray& r) {
    for (std::size_t a = 0; a < 3; ++a) {
      const double low = double{box[a]} - double{r.org[a]}, high = double{box[a + 3]} - double{r.org[a]}, d = double{r.dir[a]};
      if (d == 0) {
        misses = misses || low > 0 || high < 0;
        touches = touches || low == 0 || high == 0;
        continue;
      }
      enters = std::max(enters, std::min(low / d, high / d));
      leaves = std::min(leaves, std::max(low / d, high / d));
    }
  }
  bool touches = false;  ///< runs along a face
};

Octree grown_tree(double growth, const char* split) {
  OctreeParams params;
  params.max_depth = 4;
  params.leaf_size = 2;
  params.growth = growth;
  params.split = split;
  return build_octree_tree(mixed_scene(150, 0.1, 8), params, 1);
}

TEST(OctreeTraversal, AllTrackingsVisitTheLeavesOfPositiveChordAndNoOthers) {
  for (const char* split : {"center", "cost"}) {
    const Octree tree = grown_tree(0, split);
    const auto cells = leaf_cells(tree);
    BareTree bare(tree);
    ASSERT_EQ(cells.size(), bare.leaf_count());
    ASSERT_GT(cells.size(), 200u);
    std::mt19937 random(11);
    RayBatch rays;
    for (int i = 0; i < 120; ++i) {
      // From corners of cells and from anywhere, in any direction and in those of case 42.
      const auto& cell = pick(random, cells);
      glm::dvec3 from = 8.0 * (2.0 * point(random) - 0.5), dir = 8.0 * point(random) - from;
      for (glm::length_t a = 0; a < 3; ++a) {
        const float side = cell[static_cast<std::size_t>(a) + random() % 2 * 3];
        if (i % 3 != 0 && std::isfinite(side)) from[a] = double{side};
        if (i % 3 == 1) dir[a] = static_cast<int>(random() % 3) - 1;
      }
      if (dir != glm::dvec3(0.0)) rays.push_back(ray(from, dir));
    }
    for (const Isa isa : {Isa::scalar, best_isa()}) {
      std::size_t positive = 0;
      for (std::size_t i = 0; i < rays.size(); ++i) {
        Chord line;
        line.clip(tree.box.data(), rays[i]);
        for (std::size_t leaf = 0; leaf < cells.size(); ++leaf) {
          Chord chord = line;
          chord.clip(cells[leaf].data(), rays[i]);
          // The kernels' crossings are off by 3 roundings, and those of the parametric tracking are 20 roundings generous.
          const double slack = 64 * double{kUnitRoundoff} * (std::abs(chord.enters) + std::min(std::abs(chord.leaves), 1e6)),
                       length = chord.leaves - chord.enters;
          bool visits[3];
          for (int k = 0; k < 3; ++k) visits[k] = bare.visits(rays, i, kTrackings[k], isa, leaf);
          ASSERT_EQ(visits[1], visits[2]) << "point location and neighbour finding, ray " << i << " leaf " << leaf;
          ASSERT_LE(visits[1], visits[0]) << "parametric, ray " << i << " leaf " << leaf;
          if (chord.misses || length < -slack) {
            ASSERT_FALSE(visits[0] || visits[1]) << "ray " << i << " leaf " << leaf << " chord " << length;
          } else if (length > slack && !chord.touches) {
            ASSERT_TRUE(visits[0] && visits[1]) << "ray " << i << " leaf " << leaf << " chord " << length;
            ++positive;
          }
        }
      }
      EXPECT_GT(positive, 5 * rays.size()) << split << " " << name(isa);
    }
  }
}

/// A tree over [0, 8]^3 whose cells are divided three times everywhere: three tiny spheres in the middle of every cell of size 1.
Octree full_tree() {
  Scene scene;
  for (int i = 0; i < 512; ++i) {
    for (int k = 0; k < 3; ++k) scene.add_sphere(glm::dvec3(i % 8, i / 8 % 8, i / 64) + 0.5 + 0.01 * k, 0.001);
  }
  scene.add_triangle({0, 0, 0}, {0, 0, 0.01}, {0, 0.01, 0});
  scene.add_triangle({8, 8, 8}, {8, 8, 7.99}, {8, 7.99, 8});
  scene.finish();
  OctreeParams params;
  params.max_depth = 3;
  params.leaf_size = 1;
  params.growth = 0;
  return build_octree_tree(scene, params, 1);
}

class OctreeSteps : public testing::TestWithParam<Tracking> {};

TEST_P(OctreeSteps, EndWithinTheirBoundForAMillionAdversarialRays) {
  const Octree tree = full_tree();
  ASSERT_EQ(tree.stats.leaves, 512);
  BareTree bare(tree);
  constexpr std::uint64_t kLeaves = 3 * (8 - 1) + 1, kDepth = 3;
  // Rays on and beside planes, edges and corners, with zero, denormal and huge directions, no two the same.
  const RayBatch rays = lattice_rays(kAdversarialRays, 8);
  for (const Isa isa : {Isa::scalar, best_isa()}) {
    std::uint64_t longest = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Counters counters = bare.trace(rays, i, GetParam(), isa);
      const std::uint64_t leaves = counters.live(Event::leaf_visit);
      ASSERT_LE(counters.live(Event::node_visit), leaves * (2 * kDepth + 1));
      // The padding of the parametric tracking, which also serves rays that the other two do not, grows with the distance: from very far no cell can be told
      // from its neighbours. From near, a ray along an edge is in four cells at once.
      const Ray r = rays[i];
      const bool is_near = std::max({std::abs(r.org[0]), std::abs(r.org[1]), std::abs(r.org[2])}) < 100 && r.t_min == 0;
      ASSERT_LE(leaves, is_near ? 4 * kLeaves : bare.leaf_count()) << "ray " << i;
      longest = std::max(longest, leaves);
    }
    EXPECT_GE(longest, kLeaves) << name(isa);
  }
}

INSTANTIATE_TEST_SUITE_P(Trackings, OctreeSteps, testing::ValuesIn(kTrackings),
                         [](const testing::TestParamInfo<Tracking>& tracking) { return name_of(tracking.param); });

TEST(OctreeTraversal, AMillionAdversarialRaysAgreeWithTheListAloneAndInPackets) {
  const Scene scene = lattice_scene(8, 48);
  const RayBatch rays = lattice_rays(kAdversarialRays, 8);
  const HitBatch list = answer(scene, rays, "list", best_isa(), 64).hits;
  for (const Tracking tracking : kTrackings) {
    SCOPED_TRACE(name_of(tracking));
    const Steps steps = expect_to_end_as_list(scene, rays, "octree:leaf_size=1,tracking=" + std::string(name_of(tracking)), best_isa(), list);
    const auto leaves = static_cast<std::uint64_t>(steps.stats.leaves);
    EXPECT_LE(steps.leaves, leaves);
    EXPECT_LE(steps.nodes, leaves * (2 * static_cast<std::uint64_t>(*steps.stats.max_depth) + 1));
    EXPECT_GT(steps.leaves, 8u) << "no ray crosses the scene";
  }
}

TEST(OctreeTraversal, WalksCrossEachPlaneOnce) {
  const Octree tree = full_tree();
  BareTree bare(tree);
  std::mt19937 random(12);
  RayBatch rays;
  for (int i = 0; i < 20000; ++i) rays.push_back(ray(24.0 * point(random) - 8.0, 2.0 * point(random) - 1.0));
  for (const Tracking tracking : {Tracking::point_location, Tracking::neighbour}) {
    for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_LE(bare.trace(rays, i, tracking, Isa::scalar).live(Event::leaf_visit), 22u);
  }
}

TEST(OctreeTraversal, CountsTheSameForSingleRaysOnEveryIsa) {
  const Scene scene = mixed_scene(2000, 0.1);
  const RayBatch rays = random_rays(2000);
  for (const char* tracking : {"parametric", "point_location", "neighbour"}) {
    const std::string technique = std::string("octree:tracking=") + tracking;
    const Counters scalar = answer(scene, rays, technique, Isa::scalar, 1).closest;
    EXPECT_EQ(scalar.live(Event::node_visit), scalar.executed(Event::node_visit)) << tracking;
    for (const Isa isa : kIsas) {
      if (!available(isa)) continue;
      const Counters counters = answer(scene, rays, technique, isa, 1).closest;
      // Instruction sets with FMA round otherwise: a ray that ends within a rounding of a plane, or touches a silhouette, may go a step further. One in 10^3.
      const double tolerance = isa == Isa::scalar || isa == Isa::sse42 ? 0 : 1e-3;
      for (const Event event : {Event::node_visit, Event::leaf_visit, Event::empty_leaf_visit, Event::prim_test}) {
        const auto expected = static_cast<double>(scalar.live(event));
        EXPECT_NEAR(static_cast<double>(counters.live(event)), expected, tolerance * expected) << name(isa) << " " << tracking;
      }
    }
  }
}

TEST(OctreeTraversal, FromTheOriginVisitsTheCellsBeforeTheIntervalToo) {
  // Rays from the midst of the scene whose intervals begin behind it: nothing is visited, unless they walk from their origin on.
  const Scene scene = mixed_scene(2000, 0.1);
  RayBatch rays = random_rays(500);
  for (float& t : rays.t_min) t = 1e6f;
  for (const char* tracking : {"parametric", "point_location", "neighbour"}) {
    const std::string technique = std::string("octree:tracking=") + tracking;
    const Answer late = answer(scene, rays, technique, best_isa(), 16), early = answer(scene, rays, technique + ",start=origin", best_isa(), 16);
    EXPECT_EQ(late.closest.live(Event::leaf_visit), 0) << tracking;
    EXPECT_GT(early.closest.live(Event::leaf_visit), 500) << tracking;
    EXPECT_EQ(early.closest.live(Event::prim_hit), 0) << tracking;
  }
}

TEST(OctreeTraversal, SharesVisitsAmongCoherentRays) {
  const Scene scene = mixed_scene(2000, 0.1);
  const RayBatch rays = coherent_rays(scene);
  for (const Isa isa : kIsas) {
    if (!available(isa) || isa == Isa::scalar) continue;
    for (const char* tracking : {"parametric", "point_location", "neighbour"}) {
      const Counters counters = answer(scene, rays, std::string("octree:tracking=") + tracking, isa, simd_width(isa)).closest;
      EXPECT_LT(counters.executed(Event::node_visit), counters.live(Event::node_visit)) << name(isa) << " " << tracking;
      EXPECT_LT(counters.executed(Event::prim_test), counters.live(Event::prim_test)) << name(isa) << " " << tracking;
    }
  }
}

TEST(OctreeTraversal, MailboxSparesTestsAndChangesNothingElse) {
  const Scene scene = mixed_scene(500, 0.3);
  const RayBatch rays = random_rays(1000);
  for (const int packet : {1, 16}) {
    const Answer without = answer(scene, rays, "octree:leaf_size=1,placement=box", best_isa(), packet);
    const Answer with = answer(scene, rays, "octree:leaf_size=1,placement=box,mailbox=on", best_isa(), packet);
    EXPECT_LT(with.closest.live(Event::prim_test), without.closest.live(Event::prim_test) * 3 / 4);
    EXPECT_EQ(with.closest.live(Event::leaf_visit), without.closest.live(Event::leaf_visit));
  }
}

}  // namespace
}  // namespace raymeter
