#include "experiments/run/verification.h"

#include <array>

#include <gtest/gtest.h>

#include "accel/registry.h"

namespace raymeter {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr std::size_t kRays = 1000;  // up through both squares, the first hundred beside them

/// Two squares above each other.
Scene two_squares() {
  Scene scene;
  for (const double z : {1.0, 2.0}) scene.add_polygon(std::array<glm::dvec3, 4>{{{0, 0, z}, {1, 0, z}, {1, 1, z}, {0, 1, z}}});
  scene.finish();
  return scene;
}

class ListedErrors : public testing::Test {
protected:
  ListedErrors() {
    for (std::size_t i = 0; i < kRays; ++i) {
      set_.rays.push_back({{i < 100 ? 5.0f : 0.5f, static_cast<float>(i) / kRays, 0}, 0, {0, 0, 1}, kInf});
      set_.expected.prim.push_back(ExpectedHits::kUnknown);
    }
    const StructureEntry& list = structure_entry("list");
    structure_ = list.build(scene_, list.resolve({}), 1);
    reference_ = structure_->intersector({Isa::scalar, 1, list.resolve({})});
    answers_.hits.resize(kRays);
    for (std::size_t i = 0; i < kRays; ++i) set(i, i < 100 ? -1 : 0, i < 100 ? kInf : 1);
  }
  void set(std::size_t i, std::int32_t prim, float t) {
    answers_.hits.prim[i] = prim;
    answers_.hits.t[i] = t;
  }
  [[nodiscard]] Accuracy listed(bool oracle, double max_tests) const {
    const Oracle truth(scene_);
    Judgements judgements;
    const Verdicts verdicts = Verification(oracle ? &truth : nullptr, set_, *reference_, {.max_tests = max_tests}, 1, judgements).list_errors(answers_);
    EXPECT_EQ(verdicts.mismatches, verdicts.accuracy->mismatches());
    return *verdicts.accuracy;
  }

  Scene scene_ = two_squares();
  RaySet set_;
  std::unique_ptr<Structure> structure_;
  std::unique_ptr<Intersector> reference_;
  Answers answers_;
};

TEST_F(ListedErrors, CountAllRaysHoweverFewTheOracleIsAskedOf) {
  for (std::size_t i = 0; i < 7; ++i) set(i, 0, 1);          // false
  for (std::size_t i = 100; i < 111; ++i) set(i, -1, kInf);  // missed
  for (std::size_t i = 200; i < 240; ++i) set(i, 1, 2);      // the square behind
  for (const double max_tests : {1e9, 2.0 * 10}) {
    const Accuracy accuracy = listed(true, max_tests);
    EXPECT_EQ(accuracy.rays_checked, 1000);
    EXPECT_EQ(accuracy.false_hit, 7);
    EXPECT_EQ(accuracy.false_miss, 11);
    EXPECT_EQ(accuracy.wrong_prim, 40) << "all that differ are wrong, and so those of a sample";
  }
  const Accuracy unjudged = listed(false, 1e9);
  EXPECT_EQ(unjudged.rays_checked, 960) << "nobody can tell whether the other primitive is wrong";
  EXPECT_EQ(unjudged.wrong_prim, 0);
}

TEST_F(ListedErrors, AskWhatIsKnownOfEachRay) {
  set_.expected.prim[300] = 1;                         // as if it were known to meet the second square,
  set_.expected.prim[301] = ExpectedHits::kNothing;    // or nothing
  set_.expected.prim[302] = ExpectedHits::kSomething;  // or either
  set(302, 1, 2);
  set(303, -1, kInf);  // of this one nothing is known
  const Accuracy accuracy = listed(false, 1e9);
  EXPECT_EQ(accuracy.rays_checked, 1000);
  EXPECT_EQ(accuracy.wrong_prim, 1);
  EXPECT_EQ(accuracy.false_hit, 1);
  EXPECT_EQ(accuracy.false_miss, 1);
}

TEST_F(ListedErrors, OfAnOracleThatIsAskedOfFewOnlyTheseAreChecked) {
  set_.expected.prim[0] = ExpectedHits::kNothing;
  const Accuracy some = verify_closest(Oracle(scene_), set_.rays, answers_.hits, {2.0 * 10, 1, 1}, set_.expected);
  EXPECT_GE(some.rays_checked, 10);
  EXPECT_LE(some.rays_checked, 11) << "ten of a sample, and the one of which is known what it meets";
}

TEST_F(ListedErrors, AnExcuseIsOneRaysAlone) {
  set_.expected.prim.resize(kRays, ExpectedHits::kUnknown);
  set_.expected.excused.resize(kRays, false);
  set_.expected.source.resize(kRays, -1);
  set_.expected.excused[300] = true;
  const auto accuracy = [&](double max_tests) { return verify_closest(Oracle(scene_), set_.rays, answers_.hits, {max_tests, 1, 1}, set_.expected); };
  set(300, -1, kInf);
  EXPECT_EQ(accuracy(1e9).false_miss, 1);
  EXPECT_TRUE(accuracy(1e9).ok(0));
  set(300, 0, 1);
  set(301, -1, kInf);
  EXPECT_EQ(accuracy(1e9).false_miss, 1);
  EXPECT_FALSE(accuracy(1e9).ok(0)) << "the excused ray is right, but it is no excuse for another";
  EXPECT_TRUE(accuracy(1e9).ok(0.001));
  set(301, 0, 1);
  set_.expected.source[300] = 0;
  EXPECT_TRUE(accuracy(1e9).ok(0)) << "it meets what it leaves";
  set_.expected.source[301] = 0;
  EXPECT_FALSE(accuracy(1e9).ok(0));
}

}  // namespace
}  // namespace raymeter
