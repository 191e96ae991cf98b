#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "accel/bvh/auto_intersector.h"
#include "accel/registry.h"
#include "core/trace/trace.h"
#include "tests/support/test_rays.h"
#include "tests/support/test_scenes.h"
#include "tests/support/traces.h"

namespace raymeter {
namespace {

using test::Traced;

RayBatch fan(int count, double spread, double length) {
  RayBatch rays;
  for (int i = 0; i < count; ++i) rays.push_back(test::make_ray({0, 0, -5}, length * glm::dvec3(spread * (i % 4 - 1.5), spread * (i / 4 % 4 - 1.5), 1)));
  return rays;
}

/// One wide node with `leaves` leaves, cubes of a side.
LeafSizes cubes(int leaves, float side) {
  WideNode node{};
  for (int c = 0; c < kWideChildren; ++c) {
    for (int a = 0; a < 3; ++a) {
      node.plane[a][c] = c < leaves ? 0.0f : std::numeric_limits<float>::infinity();
      node.plane[a + 3][c] = c < leaves ? side : -std::numeric_limits<float>::infinity();
    }
    node.child[c] = WideRef(WideRef::Tag::block, static_cast<std::size_t>(c));
  }
  return leaf_sizes({&node, 1});
}

constexpr float kBox[6] = {-1, -1, -1, 1, 1, 1};

/// A group of 16 x 16 pixels in beams of 4 x 4, seen from 5 away. The box, of side 2, ends 6 away, where the four rays looked at, the diagonal's pixels 0, 5,
/// 10 and 15 with a variance of 31.25 on each axis, are 6 * pixel * sqrt(6 * 2 * 31.25) wide.
void add_group(RayBatch& rays, double pixel) {
  for (int i = 0; i < 256; ++i) {
    const int x = 4 * (i / 16 % 4) + i % 4, y = 4 * (i / 64) + i / 4 % 4;
    rays.push_back(test::make_ray({0, 0, -5}, {pixel * (x - 7.5), pixel * (y - 7.5), 1}));
  }
}

TEST(BeamEstimate, MeasuresLeavesByTheirMeanProjectedArea) {
  const LeafSizes leaves = cubes(5, 2);  // a cube of side 2 has a surface of 24, seen from everywhere 6 on the mean
  EXPECT_NEAR(leaves.per_width, 2 / std::sqrt(6.0), 1e-6);
  EXPECT_NEAR(leaves.per_area, 1 / 6.0, 1e-6);
  EXPECT_EQ(cubes(0, 1).per_width, 0);
}

TEST(BeamEstimate, ComparesABeamsWidthHalfWayWithLeaves) {
  const LeafSizes leaves = cubes(8, 1);  // s^2 = 1.5
  // In the middle of the box, 5 away, pixels are 5 * 0.01 apart; four a side have a variance of 1.25 on each axis.
  for (const double length : {1.0, 3.0, 1e-15}) {
    const double width = 5 * 0.01 * std::sqrt(6 * 2 * 1.25), size = std::sqrt(1.5);
    EXPECT_NEAR(leaves_per_ray(fan(1024, 0.01, length).view(), kBox, leaves), std::pow(1 + width / size, 2), 1e-3) << length;
    EXPECT_NEAR(leaves_per_ray(fan(1024, 0, length).view(), kBox, leaves), 1, 1e-6);
  }
  EXPECT_EQ(leaves_per_ray(fan(1024, 2, 1).view(), kBox, leaves), kBeamRays);
  RayBatch opposite;
  for (int i = 0; i < 64; ++i) opposite.push_back(test::make_ray({0, 0, 0}, {0, 0, i % 2 == 0 ? 1 : -1}));
  EXPECT_EQ(leaves_per_ray(opposite.view(), kBox, leaves), kBeamRays);
}

TEST(BeamEstimate, FindsTheWidestGroupOfASlice) {
  RayBatch rays;
  for (const double pixel : {0.001, 0.002}) add_group(rays, pixel);
  const double width = 6 * 0.001 * std::sqrt(6 * 2 * 31.25);
  EXPECT_NEAR(group_width(rays.view(0, 256), kBox), width / 2, 1e-4);
  EXPECT_NEAR(group_width(rays.view(), kBox), width, 1e-3);
  EXPECT_EQ(group_width(RayBatch().view(), kBox), 0);
  RayBatch beside;
  for (int i = 0; i < 256; ++i) beside.push_back(test::make_ray({0, 0, 5.0 + i}, {0, 0, 1}));
  EXPECT_EQ(group_width(beside.view(), kBox), 0);
}

TEST(BeamEstimate, LeavesOutWhatIsNoRay) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();
  const Ray invalid[] = {{{0, 0, -5}, 0, {0, 0, 0}, kInf},    {{0, 0, -5}, 0, {kNan, 0, 1}, kInf}, {{0, 0, -5}, 0, {0, -kInf, 1}, kInf},
                         {{0, kNan, -5}, 0, {0, 0, 1}, kInf}, {{kInf, 0, -5}, 0, {0, 0, 1}, kInf}, {{3, 0, -5}, kNan, {0, 0, 1}, kInf},
                         {{3, 0, -5}, 0, {0, 0, 1}, kNan},    {{3, 0, -5}, 1, {0, 0, 1}, 0}};
  constexpr double kPixel = 0.002;  // narrow, so that what is across the mean ray is across the axis
  RayBatch group;
  add_group(group, kPixel);
  // Of a beam the rays 0, 5, 10 and 15 are looked at, of a group 0, 85, 170 and 255. Without the two in the middle each varies as the two at its ends do.
  const double leaves = std::pow(1 + 5 * kPixel * std::sqrt(6 * 2 * 2.25) / std::sqrt(1.5), 2), width = 6 * kPixel * std::sqrt(6 * 2 * 56.25) / 2;
  for (const Ray& ray : invalid) {
    RayBatch beam;
    for (std::size_t i = 0; i < 16; ++i) beam.push_back(group[i]);
    for (const std::size_t looked_at : {5u, 10u}) beam.set(looked_at, ray);
    EXPECT_NEAR(leaves_per_ray(beam.view(), kBox, cubes(8, 1)), leaves, 1e-3);
    beam.set(15, ray);  // one ray alone does not tell
    EXPECT_EQ(leaves_per_ray(beam.view(), kBox, cubes(8, 1)), kBeamRays);
    RayBatch spoilt = group;
    for (const std::size_t looked_at : {85u, 170u}) spoilt.set(looked_at, ray);
    EXPECT_NEAR(group_width(spoilt.view(), kBox), width, 1e-3);
  }
  EXPECT_EQ(leaves_per_ray(RayBatch().view(), kBox, cubes(8, 1)), kBeamRays);
}

/// Coordinates whose sum is beyond the largest float are those of a ray all the same.
TEST(BeamEstimate, CountsRaysFromVeryFar) {
  RayBatch rays;
  for (int i = 0; i < 16; ++i) rays.push_back(test::make_ray({2e38, 2e38, 2e38}, {0, 0, 1}));
  EXPECT_EQ(leaves_per_ray(rays.view(), kBox, cubes(8, 1)), 1);
}

class NoTraversal final : public Intersector {
  void closest_hit(const RayView&, const HitView&, Counters*, std::byte*) const noexcept override {}
  void any_hit(const RayView&, std::int32_t*, Counters*, std::byte*) const noexcept override {}
};

/// Whether beams take a group where they are expected to meet `met` leaves for each that a ray meets, of cubes of a side.
bool beams_take(double met, float side, int group, Query query) {
  const double size = std::sqrt(1.5) * side;  // a cube's mean projected area is 1.5 side^2
  // Half-way, 5 away, four pixels a side have a variance of 1.25 on each axis.
  const double pixel = (std::sqrt(met) - 1) * size / (5 * std::sqrt(6 * 2 * 1.25));
  RayBatch rays;
  add_group(rays, pixel);
  EXPECT_NEAR(leaves_per_ray(rays.view(), kBox, cubes(8, side)), met, 1e-3);
  auto beams = std::make_unique<NoTraversal>();
  const Intersector* const taken = beams.get();
  const AutoIntersector automatic({std::move(beams), std::make_unique<NoTraversal>(), std::make_unique<NoTraversal>()}, kMaxPacket, 16, group, cubes(8, side),
                                  kBox);
  return &automatic.suited(rays.view(), query) == taken;
}

TEST(AutoTraversal, GivesBeamsMoreLeavesWhereSlimGroupsShareTheirWay) {
  const float slim = 0.001f, wide = 0.02f;  // groups of 0.004 and 0.07 of the box where 4 leaves are met
  for (const float side : {slim, wide}) {
    EXPECT_TRUE(beams_take(2.9, side, 256, Query::closest)) << side;
    EXPECT_TRUE(beams_take(2.9, side, 16, Query::closest)) << side;
    EXPECT_FALSE(beams_take(5.1, side, 256, Query::closest)) << side;
    EXPECT_TRUE(beams_take(1.09, side, 256, Query::any)) << side;
    EXPECT_FALSE(beams_take(1.11, side, 256, Query::any)) << side;
  }
  EXPECT_TRUE(beams_take(4, slim, 256, Query::closest));
  EXPECT_FALSE(beams_take(4, wide, 256, Query::closest));
  EXPECT_FALSE(beams_take(4, slim, 16, Query::closest));  // each beam goes down alone
  EXPECT_FALSE(beams_take(4, slim, 256, Query::any));
}

TEST(AutoTraversal, ChoosesForEachSliceAndSaysWhat) {
  const Scene& scene = test::scene_named("mixed");
  const TechniqueSpec spec = parse_technique("bvh");
  const auto structure = spec.structure->build(scene, spec.params, 1);
  const RayBatch near = fan(1024, 0.0001, 1), wide = fan(1024, 2, 1);
  RayBatch both = near;
  both.append(wide);
  const auto choice = [&](const RayBatch& rays, int packet) {
    const auto intersector = structure->intersector({best_isa(), packet, spec.params});
    HitBatch hits;
    trace_closest(*intersector, rays, hits, 1);
    EXPECT_EQ(intersector->choice(Query::any), "");
    return intersector->choice(Query::closest);
  };
  const auto some = [](const RayBatch& rays, std::size_t count) {
    RayBatch first;
    for (std::size_t i = 0; i < count; ++i) first.push_back(rays[i]);
    return first;
  };
  EXPECT_EQ(choice(near, kMaxPacket), "traversal=beam");
  EXPECT_EQ(choice(near, std::max(4, simd_width(best_isa()) / 2)), "traversal=stream");
  EXPECT_EQ(choice(near, 1), "traversal=single");
  EXPECT_EQ(choice(some(near, 4), kMaxPacket), "traversal=beam");
  EXPECT_EQ(choice(some(near, 3), kMaxPacket), "traversal=single");
  EXPECT_EQ(choice(wide, kMaxPacket), "traversal=stream");
  EXPECT_EQ(choice(some(wide, 16), kMaxPacket), "traversal=single");  // of four octants
  EXPECT_EQ(choice(some(wide, 32), kMaxPacket), "traversal=stream");
  EXPECT_EQ(choice(both, kMaxPacket), "traversal=beam|stream");
  const auto several = structure->intersector({best_isa(), kMaxPacket, spec.params});
  HitBatch hits;
  Column<std::int32_t> blockers;
  trace_closest(*several, near, hits, 1);
  trace_closest(*several, some(near, 1), hits, 1);
  trace_any(*several, wide, blockers, 1);
  EXPECT_EQ(choices(*several), "traversal=single|beam; any: traversal=stream");
  EXPECT_EQ(several->suited(near.view(), Query::closest).choice(Query::closest), "");
  EXPECT_NE(&several->suited(near.view(), Query::any), &several->suited(wide.view(), Query::any));

  const auto work = [&](const char* technique, const RayBatch& rays, int threads) {
    const TechniqueSpec one = parse_technique(technique);
    return test::trace(*structure, {best_isa(), kMaxPacket, one.params}, rays, threads);
  };
  Traced beam = work("bvh:traversal=beam", near, 1), stream = work("bvh:traversal=stream", wide, 1);
  beam.closest.add(stream.closest);
  for (const int threads : {1, 2, 7}) {
    const Traced found = work("bvh", both, threads);
    test::expect_same_hits(found.hits, test::trace_list(scene, best_isa(), both).hits, both);
    beam.closest.ray_count = found.closest.ray_count;
    EXPECT_EQ(found.closest, beam.closest) << threads;
  }
}

}  // namespace
}  // namespace raymeter
