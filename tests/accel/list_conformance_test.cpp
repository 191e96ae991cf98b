// What the list must keep on every instruction set and scene, since all other techniques are held against it.

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "experiments/verify/verify.h"
#include "tests/support/test_rays.h"
#include "tests/support/traces.h"

namespace raymeter {
namespace {

using test::expect_same_hits;
using test::Listed;
using test::Reference;
using test::scene_named;
using test::scenes;
using test::trace_list;

class ListConformance : public testing::TestWithParam<Isa> {
protected:
  void SetUp() override {
    if (!available(GetParam())) GTEST_SKIP() << name(GetParam()) << " is not available on this machine";
  }
};

TEST_P(ListConformance, IsCorrectByTheOracle) {
  for (const Scene& scene : scenes()) {
    SCOPED_TRACE(scene.name);
    const Oracle oracle(scene);
    const Reference reference(scene, GetParam());
    const RayBatch& rays = reference.rays;
    int shown = 0;
    for (std::size_t i = 0; i < rays.size() && shown < 3; ++i) {
      const Verdict verdict = oracle.closest(rays[i], reference.list.hits.t[i], reference.list.hits.prim[i]).verdict;
      if (verdict == Verdict::correct) continue;
      ++shown;
      const Ray ray = rays[i];
      ADD_FAILURE() << std::hexfloat << "verdict " << static_cast<int>(verdict) << " for t " << reference.list.hits.t[i] << " prim "
                    << reference.list.hits.prim[i] << " of ray " << i << ": org " << ray.org[0] << ' ' << ray.org[1] << ' ' << ray.org[2] << " dir "
                    << ray.dir[0] << ' ' << ray.dir[1] << ' ' << ray.dir[2] << " in " << ray.t_min << ' ' << ray.t_max;
    }
    const Accuracy any = verify_any(oracle, rays, reference.list.blockers, {std::numeric_limits<double>::infinity(), 1, 1});
    EXPECT_EQ(any.mismatches(), 0);
    EXPECT_EQ(any.rays_checked, static_cast<std::int64_t>(rays.size()));
  }
}

TEST_P(ListConformance, IntervalsAreClosed) {
  for (const Scene& scene : scenes()) {
    SCOPED_TRACE(scene.name);
    const RayBatch rays = test::hard_rays(scene, 7);
    const HitBatch hits = trace_list(scene, GetParam(), rays).hits;
    RayBatch ends;
    std::vector<std::size_t> of;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (hits.prim[i] < 0) continue;
      Ray ray = rays[i];
      ray.t_max = hits.t[i];
      ends.push_back(ray);
      ray.t_min = hits.t[i];
      ends.push_back(ray);
      of.insert(of.end(), 2, i);
    }
    const HitBatch at_ends = trace_list(scene, GetParam(), ends).hits;
    for (std::size_t k = 0; k < of.size(); ++k) {
      ASSERT_EQ(at_ends.t[k], hits.t[of[k]]) << "ray " << of[k];
      ASSERT_EQ(at_ends.prim[k], hits.prim[of[k]]) << "ray " << of[k];
    }
  }
}

TEST_P(ListConformance, InvalidRaysMissAndZeroHasNoSign) {
  for (const Scene& scene : scenes()) {
    SCOPED_TRACE(scene.name);
    const RayBatch rays = test::hard_rays(scene, 7);
    RayBatch flipped;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      Ray ray = rays[i];
      for (float* x : {&ray.org[0], &ray.org[1], &ray.org[2], &ray.dir[0], &ray.dir[1], &ray.dir[2], &ray.t_min, &ray.t_max}) {
        if (*x == 0) *x = -*x;
      }
      flipped.push_back(ray);
    }
    const Listed traced = trace_list(scene, GetParam(), rays);
    expect_same_hits(trace_list(scene, GetParam(), flipped).hits, traced.hits, rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      EXPECT_FALSE(std::signbit(traced.hits.t[i]) && traced.hits.t[i] == 0);
      if (test::valid(rays[i])) continue;
      ASSERT_EQ(traced.hits.prim[i], -1);
      ASSERT_EQ(traced.hits.t[i], std::numeric_limits<float>::infinity());
      ASSERT_EQ(traced.hits.u[i], 0);
      ASSERT_EQ(traced.hits.v[i], 0);
      ASSERT_EQ(traced.blockers[i], -1);
    }
  }
}

TEST_P(ListConformance, TiesGoToTheSmallestId) {
  for (const char* coincident : {"coincident spheres", "coincident triangles"}) {
    const Reference reference(scene_named(coincident), GetParam());
    int met = 0;
    for (const std::int32_t prim : reference.list.hits.prim) {
      EXPECT_LE(prim, 0);
      met += prim == 0;
    }
    EXPECT_GT(met, 500);
  }
}

INSTANTIATE_TEST_SUITE_P(List, ListConformance, testing::ValuesIn(kIsas), [](const testing::TestParamInfo<Isa>& isa) { return std::string(name(isa.param)); });

}  // namespace
}  // namespace raymeter
