#include <gtest/gtest.h>

#include "accel/registry.h"
#include "experiments/cases/hard_case.h"
#include "tests/support/answer.h"

namespace raymeter {
namespace {

using test::answer;

/// Of rays at points of the edges of boxes of twelve triangles, those whose hits a setting loses.
std::size_t lost(const Problem& problem, const char* technique, Isa isa) {
  const auto right = answer(problem.scene, problem.set.rays, "bvh", isa, 16), weak = answer(problem.scene, problem.set.rays, technique, isa, 16);
  std::size_t count = 0;
  for (std::size_t i = 0; i < problem.set.rays.size(); ++i) count += weak.hits.prim[i] < 0 && right.hits.prim[i] >= 0 ? 1 : 0;
  return count;
}

/// weak_box_kernel.h: 12 ulp are enough with one of Newton's steps, 4096 with the estimate alone; a division a plane needs no more than a reciprocal.
TEST(WeakBoxes, ProvenPaddingMakesEstimatesSafe) {
  const Problem near = hard_case("hard:box_edges").make(50'000, 7), far = hard_case("hard:box_edges_far").make(50'000, 7);
  for (const Isa isa : kIsas) {
    if (!available(isa)) continue;
    for (const char* safe : {"bvh:box_test=unpadded,box_padding=10", "bvh:reciprocal=newton,box_test=unpadded,box_padding=12",
                             "bvh:reciprocal=estimate,box_test=unpadded,box_padding=4096", "bvh:reciprocal=none"}) {
      EXPECT_EQ(lost(near, safe, isa), 0u) << safe << ' ' << name(isa);
      EXPECT_EQ(lost(far, safe, isa), 0u) << safe << ' ' << name(isa);
    }
    // Without the room of built boxes the roundings of the test itself lose hits.
    const std::size_t rounded = lost(near, "bvh:box_bounds=tight,box_test=unpadded", isa);
    EXPECT_GT(rounded, 0u) << name(isa);
    EXPECT_GT(lost(near, "bvh:box_test=unpadded,reciprocal=estimate", isa), 1000u) << name(isa);
  }
}

}  // namespace
}  // namespace raymeter
