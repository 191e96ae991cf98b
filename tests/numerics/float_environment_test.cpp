// A tracer inside of a program that flushes denormal numbers, rounds otherwise or traps: answers are the same, and the program finds its settings as they were.

#include <array>
#include <cfenv>
#include <limits>
#include <string_view>

#include <gtest/gtest.h>

#include "core/base/ieee_arithmetic.h"
#include "experiments/cases/hard_case.h"
#include "tests/support/shadows.h"
#include "tests/support/traces.h"

namespace raymeter {
namespace {

// Bits of MXCSR.
constexpr unsigned kFlags = 0x3F, kDenormalsAreZero = 0x40, kInvalidMask = 0x80, kDivideMask = 0x200, kRoundUp = 0x4000, kFlushToZero = 0x8000, kPlain = 0x1F80;

/// Settings of the calling thread, for a while.
class Settings {
public:
  explicit Settings(unsigned mxcsr) noexcept : before_(__builtin_ia32_stmxcsr()) { __builtin_ia32_ldmxcsr(mxcsr); }
  ~Settings() { __builtin_ia32_ldmxcsr(before_); }
  Settings(const Settings&) = delete;
  Settings& operator=(const Settings&) = delete;

private:
  unsigned before_;
};

/// At run time.
float product(float a, float b) {
  const volatile float first = a, second = b;
  return first * second;
}

TEST(IeeeArithmetic, HoldsWithinItsScopeAlone) {
  const Settings settings(kPlain | kFlushToZero | kDenormalsAreZero);
  EXPECT_EQ(product(0x1p-149f, 1), 0);
  EXPECT_EQ(product(0x1p-100f, 0x1p-40f), 0);
  {
    const IeeeArithmetic ieee;
    EXPECT_EQ(product(0x1p-149f, 1), 0x1p-149f);
    EXPECT_EQ(product(0x1p-100f, 0x1p-40f), 0x1p-140f);
  }
  EXPECT_EQ(__builtin_ia32_stmxcsr() & ~kFlags, kPlain | kFlushToZero | kDenormalsAreZero);
  EXPECT_EQ(product(0x1p-149f, 1), 0);
}

/// Several slices of a case's rays, so that workers take part.
RayBatch slices_of(const Problem& problem) {
  RayBatch rays = problem.set.rays;
  while (rays.size() < 2 * kSliceRays) rays.append(RayBatch(rays));
  return rays;
}

class FloatEnvironment : public testing::TestWithParam<std::string> {};

TEST_P(FloatEnvironment, OfTheCallerChangesNoAnswer) {
  const TechniqueSpec spec = parse_technique(GetParam());
  for (const std::string_view name : {"denormal_directions", "extreme_directions", "beside_box", "closed_mesh_tiniest"}) {
    SCOPED_TRACE(name);
    const Problem problem = hard_case(name).make(300, 1);
    const RayBatch rays = slices_of(problem);
    for (const Isa isa : kIsas) {
      if (!available(isa)) continue;
      SCOPED_TRACE(raymeter::name(isa));
      const auto traced = [&](unsigned mxcsr, int threads) {
        const Settings settings(mxcsr);
        const auto structure = spec.structure->build(problem.scene, spec.params, threads);
        const auto intersector = structure->intersector({isa, 16, spec.params});
        intersector->prepare(rays.view(), Query::closest, threads);
        HitBatch hits;
        trace_closest(*intersector, rays, hits, threads);
        EXPECT_EQ(__builtin_ia32_stmxcsr() & ~kFlags, mxcsr);
        return hits;
      };
      const HitBatch expected = traced(kPlain, 1);
      for (const int threads : {1, 3}) test::expect_same_hits(traced(kPlain | kFlushToZero | kDenormalsAreZero, threads), expected, rays);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Structures, FloatEnvironment, testing::ValuesIn([] {
                           std::vector<std::string> names;
                           for (const StructureEntry& entry : structures()) names.emplace_back(entry.name);
                           return names;
                         }()),
                         [](const testing::TestParamInfo<std::string>& technique) { return technique.param; });

/// The one way to kernels that cuts no slices.
TEST(FloatEnvironment, OfTheCallerChangesNoShadow) {
  Problem problem = hard_case("denormal_directions").make(300, 1);
  problem.scene.lights = {Light{}};
  test::Shadow shadow;
  for (std::size_t i = 0; i < problem.set.rays.size(); ++i) {
    shadow.rays.push_back(problem.set.rays[i]);
    shadow.origins.push_back(0, 0);
  }
  const TechniqueSpec spec = parse_technique("bvh");
  const auto structure = spec.structure->build(problem.scene, spec.params, 1);
  const auto intersector = structure->intersector({Isa::scalar, 16, spec.params});
  Column<std::int32_t> expected, blockers;
  trace_any(*intersector, shadow.rays, expected, 1);
  {
    const Settings settings(kPlain | kFlushToZero | kDenormalsAreZero);
    (void)test::find(*test::cache_of(problem.scene, "update=serial", {Isa::scalar, 16, 1, {}}, *intersector), shadow, 1, blockers);
  }
  for (std::size_t i = 0; i < expected.size(); ++i) ASSERT_EQ(blockers[i] >= 0, expected[i] >= 0) << "ray " << i;
}

/// Other roundings and traps too, while rays are traced.
TEST(FloatEnvironment, RoundingAndTrapsOfTheCallerAreHisAlone) {
  const Problem problem = hard_case("start_on_surface").make(0, 1);
  const TechniqueSpec spec = parse_technique("bvh");
  const auto structure = spec.structure->build(problem.scene, spec.params, 1);
  const auto intersector = structure->intersector({Isa::scalar, 16, spec.params});
  HitBatch expected, hits;
  trace_closest(*intersector, problem.set.rays, expected, 1);
  constexpr unsigned kTraps = kPlain & ~(kInvalidMask | kDivideMask);
  for (const int threads : {1, 2}) {
    {
      const Settings settings(kTraps | kRoundUp);
      trace_closest(*intersector, problem.set.rays, hits, threads);
      EXPECT_EQ(__builtin_ia32_stmxcsr(), kTraps | kRoundUp) << "the kernels' own flags are none of the caller's";
    }
    test::expect_same_hits(hits, expected, problem.set.rays);
  }
}

}  // namespace
}  // namespace raymeter
