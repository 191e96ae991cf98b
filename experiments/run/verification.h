#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "experiments/config/config.h"
#include "experiments/record/run_records.h"
#include "experiments/run/pass.h"
#include "experiments/verify/verify.h"

namespace raymeter {

/// What is written down of the oracle's judgement; `distances`: there are hits whose t it has looked at.
[[nodiscard]] AccuracyRecord to_record(const Accuracy& accuracy, bool distances);

/// What verification says of a cell.
struct Verdicts {
  bool right = true;
  std::int64_t mismatches = 0;       ///< rays that differ from the reference or from the truth
  std::optional<Accuracy> accuracy;  ///< where the oracle is asked
};

/// What the oracle has said of the nearest hits of a ray set, by their hash: instruction sets that answer alike are judged once.
using Judgements = std::map<std::uint64_t, Accuracy>;

/// Holds the cells of one ray set and one instruction set against a reference technique, whose answers what is expected of the rays and the exact oracle
/// have judged. Techniques agree bit for bit, so that a cell that equals the reference is as right as it; one that differs is judged itself. Blockers may
/// differ: those that do are judged too.
class Verification {
public:
  /// `oracle` may be null: no exact check. `judgements` are those of this oracle, ray set, options and seed.
  Verification(const Oracle* oracle, const RaySet& rays, Intersector& reference, const VerifyOptions& options, std::uint64_t seed, Judgements& judgements);
  [[nodiscard]] Verdicts judge(const Answers& answers) const;
  /// What a peer from outside or a weak setting answers: it is right whatever it says, but what it says is listed, for all rays. Where it is known what a ray
  /// meets, that decides; else misses and hits that the reference, which is true, does not have are false, and of hits on other primitives than its the oracle
  /// tells which are wrong: of all, or of a sample, whose share then stands for all. The errors of t are those of a sample of all rays.
  [[nodiscard]] Verdicts list_errors(const Answers& answers) const;

private:
  [[nodiscard]] Accuracy find_accuracy(const RayBatch& rays, const Answers& answers, const ExpectedHits& expected) const;
  [[nodiscard]] std::int64_t count_wrong_blockers(const Answers& answers) const;
  void judge_others(const Answers& answers, const std::vector<std::size_t>& others, Accuracy& accuracy) const;

  const Oracle* oracle_;
  const RaySet& rays_;
  VerifyOptions options_;
  std::uint64_t seed_;
  Answers reference_;
  std::optional<Accuracy> accuracy_;
};

}  // namespace raymeter
