// The hard cases, by every structure on every instruction set: what they must meet, and the same bits from all of them.

#include "experiments/cases/hard_case.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include <gtest/gtest.h>

#include "experiments/verify/verify.h"
#include "tests/support/traces.h"

namespace raymeter {
namespace {

constexpr int kRays = 300;  // where they are at random

const Problem& problem_of(const HardCase& hard) {
  static std::map<std::string_view, Problem> problems;
  const auto [found, added] = problems.try_emplace(hard.name);
  if (added) found->second = hard.make(kRays, 1);
  return found->second;
}

struct Answers {
  HitBatch hits;
  Column<std::int32_t> blocker;
};

Answers answers_of(const Problem& problem, const Structure& structure, const QueryOptions& options) {
  const auto intersector = structure.intersector(options);
  intersector->prepare(problem.set.rays.view(), problem.set.query, 1);
  Answers answers;
  if (problem.set.query == Query::closest)
    trace_closest(*intersector, problem.set.rays, answers.hits, 1);
  else
    trace_any(*intersector, problem.set.rays, answers.blocker, 1);
  return answers;
}

/// Of the list, one ray at a time.
const Answers& reference_of(const HardCase& hard, Isa isa) {
  static std::map<std::pair<std::string_view, Isa>, Answers> references;
  const auto [found, added] = references.try_emplace({hard.name, isa});
  if (added) {
    const StructureEntry& list = structure_entry("list");
    const ParamValues params = list.resolve({});
    found->second = answers_of(problem_of(hard), *list.build(problem_of(hard).scene, params, 1), {isa, 1, params});
  }
  return found->second;
}

class HardCases : public testing::TestWithParam<const HardCase*> {};

/// What `list` answers, and so all.
TEST_P(HardCases, AreAnsweredAsTheyMustBe) {
  const HardCase& hard = *GetParam();
  const Problem& problem = problem_of(hard);
  const Oracle oracle(problem.scene);
  const ExpectedHits& expected = problem.set.expected;
  for (const Isa isa : kIsas) {
    if (!available(isa)) continue;
    SCOPED_TRACE(name(isa));
    const Answers& answers = reference_of(hard, isa);
    const bool closest = problem.set.query == Query::closest;
    const OracleBudget budget{2e7, 1, 1};
    const Accuracy accuracy = closest ? verify_closest(oracle, problem.set.rays, answers.hits, budget, expected)
                                      : verify_any(oracle, problem.set.rays, answers.blocker, budget, expected);
    EXPECT_TRUE(accuracy.ok(0)) << "misses " << accuracy.false_miss << ", false hits " << accuracy.false_hit << ", wrong primitives " << accuracy.wrong_prim
                                << ", self-hits " << accuracy.self_hits.value_or(0) << " of " << accuracy.rays_checked << ", excused " << accuracy.excused;
    if (!closest) continue;
    double worst = 0;
    for (std::size_t i = 0; i < answers.hits.size(); ++i) {
      ASSERT_FALSE(std::isnan(answers.hits.t[i]) || std::isnan(answers.hits.u[i]) || std::isnan(answers.hits.v[i])) << "ray " << i;
      ASSERT_TRUE(answers.hits.prim[i] < 0 || std::isfinite(answers.hits.t[i])) << "ray " << i;
      if (expected.t.empty() || answers.hits.prim[i] < 0 || std::isnan(expected.t[i])) continue;
      worst = std::max(worst, ulps(answers.hits.t[i], expected.t[i]));
    }
    EXPECT_LE(worst, hard.t_ulp_max);
    RecordProperty("t_ulp_max_" + std::string(name(isa)), std::to_string(worst));
  }
}

TEST_P(HardCases, AreAnsweredByEveryStructureAsByTheListBitForBit) {
  const HardCase& hard = *GetParam();
  const Problem& problem = problem_of(hard);
  for (const std::string& technique : test::all_traversals()) {
    SCOPED_TRACE(technique);
    const TechniqueSpec spec = parse_technique(technique);
    const auto structure = spec.structure->build(problem.scene, spec.params, 1);
    for (const Isa isa : kIsas) {
      if (!available(isa)) continue;
      const Answers& expected = reference_of(hard, isa);
      for (const int packet : {5, kMaxPacket}) {
        SCOPED_TRACE(std::string(name(isa)) + " packet " + std::to_string(packet));
        const Answers answers = answers_of(problem, *structure, {isa, packet, spec.params});
        if (problem.set.query == Query::closest) {
          test::expect_same_hits(answers.hits, expected.hits, problem.set.rays);
        } else {
          for (std::size_t i = 0; i < expected.blocker.size(); ++i) ASSERT_EQ(answers.blocker[i] >= 0, expected.blocker[i] >= 0) << "ray " << i;
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Cases, HardCases, testing::ValuesIn([] {
                           std::vector<const HardCase*> rows;
                           for (const HardCase& row : hard_cases()) rows.push_back(&row);
                           return rows;
                         }()),
                         [](const testing::TestParamInfo<const HardCase*>& row) { return std::string(row.param->name); });

class OverlappingQuads : public testing::TestWithParam<std::string> {};

/// Numerics case 20: an image of 1024 x 1024 of two quads that overlap in one plane, added in either order. The first wins wherever both are seen.
TEST_P(OverlappingQuads, ShowNoSpeckle) {
  constexpr int kSide = 1024;
  const std::array<glm::dvec3, 4> low{{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}}}, high{{{1, 1, 0}, {3, 1, 0}, {3, 3, 0}, {1, 3, 0}}};
  const glm::dvec3 eye(1.25, 0.75, 2.5);
  RayBatch rays;
  std::vector<int> seen;  // 1: low, 2: high, 3: both, 0: none
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const glm::dvec3 at(3.5 * (x + 0.3) / kSide - 0.25, 3.5 * (y + 0.3) / kSide - 0.25, 0);
      const glm::vec3 o(eye), d(at - eye);
      rays.push_back({{o.x, o.y, o.z}, 0, {d.x, d.y, d.z}, std::numeric_limits<float>::infinity()});
      const auto within = [&](double from, double to) { return std::min(at.x, at.y) > from && std::max(at.x, at.y) < to; };
      seen.push_back((within(0, 2) ? 1 : 0) + (within(1, 3) ? 2 : 0));
    }
  }
  const Isa isa = *std::ranges::max_element(kIsas, {}, [](Isa one) { return available(one) ? static_cast<int>(one) : -1; });
  const TechniqueSpec spec = parse_technique(GetParam());
  for (const bool swapped : {false, true}) {
    Scene scene;
    scene.add_polygon(swapped ? high : low);
    scene.add_polygon(swapped ? low : high);
    scene.finish();
    const auto structure = spec.structure->build(scene, spec.params, 1);
    const auto intersector = structure->intersector({isa, 16, spec.params});
    intersector->prepare(rays.view(), Query::closest, 1);
    HitBatch hits;
    trace_closest(*intersector, rays, hits, 1);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const int alone = swapped ? 2 - seen[i] : seen[i] - 1;  // the id of what is seen alone
      ASSERT_EQ(hits.prim[i], seen[i] == 0 ? -1 : seen[i] == 3 ? 0 : alone) << "pixel " << i % kSide << ' ' << i / kSide;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Structures, OverlappingQuads, testing::ValuesIn([] {
                           std::vector<std::string> names;
                           for (const StructureEntry& entry : structures()) names.emplace_back(entry.name);
                           return names;
                         }()),
                         [](const testing::TestParamInfo<std::string>& technique) { return technique.param; });

TEST(HardCase, OracleAgreesWithWhatIsKnownByConstruction) {
  for (const HardCase& hard : hard_cases()) {
    const Problem& problem = problem_of(hard);
    if (problem.set.expected.prim.empty() || problem.set.query != Query::closest || problem.scene.prim_count() > 4000) continue;
    SCOPED_TRACE(hard.name);
    const Oracle oracle(problem.scene);
    for (std::size_t i = 0; i < problem.set.rays.size(); ++i) {
      const std::int32_t prim = problem.set.expected.prim[i];
      if (prim == ExpectedHits::kUnknown) continue;
      const auto exact = oracle.nearest(problem.set.rays[i]);
      ASSERT_EQ(exact.has_value(), prim != ExpectedHits::kNothing) << "ray " << i;
      if (!exact) continue;
      if (prim >= 0) {
        ASSERT_EQ(exact->prim, prim) << "ray " << i;
      }
      const double t = problem.set.expected.t[i];
      if (!std::isnan(t)) {
        ASSERT_NEAR(exact->t, t, 0x1p-36 * std::abs(t)) << "ray " << i;
      }
    }
  }
}

}  // namespace
}  // namespace raymeter
