#include "experiments/run/verification.h"

#include <algorithm>
#include <cmath>

namespace raymeter {

AccuracyRecord to_record(const Accuracy& accuracy, bool distances) {
  AccuracyRecord record{accuracy.rays_checked, accuracy.false_miss, accuracy.false_hit, accuracy.wrong_prim, accuracy.self_hits, {}, {}, {}};
  if (distances) {
    record.t_ulp_p50 = accuracy.t_ulp_p50;
    record.t_ulp_p99 = accuracy.t_ulp_p99;
    record.t_ulp_max = accuracy.t_ulp_max;
  }
  return record;
}

Verification::Verification(const Oracle* oracle, const RaySet& rays, Intersector& reference, const VerifyOptions& options, std::uint64_t seed,
                           Judgements& judgements)
    : oracle_(oracle), rays_(rays), options_(options), seed_(seed) {
  run_pass({reference}, rays, 0, reference_);
  if (oracle_ == nullptr) return;
  if (reference_.kind != Answers::Kind::closest) {  // the hash of blockers does not say which they are
    accuracy_ = find_accuracy(rays.rays, reference_, rays.expected);
    return;
  }
  const auto [judged, is_new] = judgements.try_emplace(reference_.hash());
  if (is_new) judged->second = find_accuracy(rays.rays, reference_, rays.expected);
  accuracy_ = judged->second;
}

Accuracy Verification::find_accuracy(const RayBatch& rays, const Answers& answers, const ExpectedHits& expected) const {
  const OracleBudget budget{options_.max_tests, seed_};
  return answers.kind == Answers::Kind::closest ? verify_closest(*oracle_, rays, answers.hits, budget, expected)
                                                : verify_any(*oracle_, rays, answers.blocker, budget, expected);
}

std::int64_t Verification::count_wrong_blockers(const Answers& answers) const {
  RayBatch others;
  Answers their;
  their.kind = Answers::Kind::any;
  for (std::size_t i = 0; i < answers.blocker.size(); ++i) {
    if (answers.blocker[i] == reference_.blocker[i] || answers.blocker[i] < 0) continue;
    others.push_back(rays_.rays[i]);
    their.blocker.push_back(answers.blocker[i]);
  }
  return others.size() == 0 ? 0 : find_accuracy(others, their, {}).mismatches();
}

Verdicts Verification::judge(const Answers& answers) const {
  Verdicts verdicts;
  const std::int64_t different = count_differences(answers, reference_);
  verdicts.mismatches = different;
  if (oracle_ != nullptr) {
    verdicts.accuracy = different == 0 ? *accuracy_ : find_accuracy(rays_.rays, answers, rays_.expected);
    if (different == 0 && answers.kind == Answers::Kind::any) verdicts.accuracy->false_hit += count_wrong_blockers(answers);
    verdicts.mismatches = std::max(different, verdicts.accuracy->mismatches());
    verdicts.right = verdicts.accuracy->ok(options_.hit_mismatch_max);
  }
  if (static_cast<double>(different) > options_.hit_mismatch_max * static_cast<double>(rays_.rays.size())) verdicts.right = false;
  return verdicts;
}

/// Judges hits where the reference has another primitive's; without an oracle nobody can.
void Verification::judge_others(const Answers& answers, const std::vector<std::size_t>& others, Accuracy& accuracy) const {
  const auto count = static_cast<std::int64_t>(others.size());
  if (count == 0) return;
  if (oracle_ == nullptr) {
    accuracy.rays_checked -= count;
    return;
  }
  RayBatch rays;
  Answers their;
  their.hits.resize(others.size());
  for (std::size_t k = 0; k < others.size(); ++k) {
    rays.push_back(rays_.rays[others[k]]);
    their.hits.t[k] = answers.hits.t[others[k]];
    their.hits.prim[k] = answers.hits.prim[others[k]];
  }
  const Accuracy judged = find_accuracy(rays, their, {});
  const double share = static_cast<double>(judged.mismatches()) / static_cast<double>(judged.rays_checked);
  accuracy.wrong_prim += std::llround(share * static_cast<double>(count));
}

Verdicts Verification::list_errors(const Answers& answers) const {
  const bool closest = answers.kind == Answers::Kind::closest;
  Verdicts verdicts;
  Accuracy& accuracy = verdicts.accuracy.emplace();
  if (closest && oracle_ != nullptr) accuracy = find_accuracy(rays_.rays, answers, rays_.expected);
  const Column<std::int32_t>& theirs = closest ? answers.hits.prim : answers.blocker;
  const Column<std::int32_t>& ours = closest ? reference_.hits.prim : reference_.blocker;
  const Column<std::int32_t>& known = rays_.expected.prim;
  accuracy.rays_checked = static_cast<std::int64_t>(theirs.size());
  accuracy.false_miss = accuracy.false_hit = accuracy.wrong_prim = 0;
  std::vector<std::size_t> others;
  for (std::size_t i = 0; i < theirs.size(); ++i) {
    const bool told = !known.empty() && known[i] != ExpectedHits::kUnknown;
    const std::int32_t truth = told ? known[i] : ours[i] < 0 ? ExpectedHits::kNothing : ExpectedHits::kSomething;
    const Verdict verdict = expected_verdict(truth, theirs[i], closest);
    accuracy.false_miss += verdict == Verdict::false_miss;
    accuracy.false_hit += verdict == Verdict::false_hit;
    accuracy.wrong_prim += verdict == Verdict::wrong_prim;
    if (!told && closest && theirs[i] >= 0 && ours[i] >= 0 && theirs[i] != ours[i]) others.push_back(i);
  }
  judge_others(answers, others, accuracy);
  verdicts.mismatches = accuracy.mismatches();
  return verdicts;
}

}  // namespace raymeter
