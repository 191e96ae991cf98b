#include "experiments/run/frame_verification.h"

#include <array>

#include <fmt/format.h>

namespace raymeter {

FrameVerification::FrameVerification(const Oracle* oracle, const Frame& frame, Intersector& reference, const VerifyOptions& options, std::uint64_t seed)
    : frame_(frame), tracer_(reference), options_(options) {
  if (oracle != nullptr) ask_oracle(*oracle, seed);
}

void FrameVerification::ask_oracle(const Oracle& oracle, std::uint64_t seed) {
  constexpr std::array kinds{RayKind::primary, RayKind::shadow, RayKind::reflection};
  const double max_tests = options_.max_tests / kinds.size();
  accuracy_.emplace();
  for (const RayKind kind : kinds) {
    const RaySet set = make_rays(*frame_.scene, kind, frame_.model, seed, tracer_, 0);
    if (set.rays.size() == 0) continue;
    Answers answers;
    run_pass({tracer_}, set, 0, answers);
    const Accuracy one = set.query == Query::any ? verify_any(oracle, set.rays, answers.blocker, {max_tests, seed})
                                                 : verify_closest(oracle, set.rays, answers.hits, {max_tests, seed});
    if (kind == RayKind::primary) {
      accuracy_ = one;  // with its errors of t
      continue;
    }
    accuracy_->rays_checked += one.rays_checked;
    accuracy_->false_miss += one.false_miss;
    accuracy_->false_hit += one.false_hit;
    accuracy_->wrong_prim += one.wrong_prim;
  }
}

const FrameVerification::Reference& FrameVerification::reference(double min_weight) {
  const auto [found, added] = references_.try_emplace(min_weight);
  if (added) {
    Frame frame = frame_;
    frame.termination.min_weight = min_weight;
    found->second.rays = run_frame({tracer_}, frame, 0, found->second.answers).rays.all();
  }
  return found->second;
}

FrameVerdict FrameVerification::judge(const Answers& answers, double min_weight, const Column<glm::vec3>& bound) {
  FrameVerdict verdict;
  verdict.mismatches = count_differences(answers, reference(min_weight).answers);
  const Reference& full = reference(0);
  verdict.error = image_error(answers.image, full.answers.image);
  verdict.rays_full = full.rays;
  verdict.bound = check_bound(answers.image, full.answers.image, bound);
  const std::size_t pixels = answers.image.pixel.size();
  if (static_cast<double>(verdict.mismatches) > options_.hit_mismatch_max * static_cast<double>(pixels))
    verdict.complaint = fmt::format("{} of {} pixels are wrong", verdict.mismatches, pixels);
  else if (verdict.mismatches == 0 && verdict.bound.exceeded > 0)
    verdict.complaint = fmt::format("{} of {} pixels are further from the image that is cut nowhere than promised", verdict.bound.exceeded, pixels);
  else if (accuracy_ && !accuracy_->ok(options_.hit_mismatch_max))
    verdict.complaint = fmt::format("{} of {} rays of the reference have wrong hits", accuracy_->mismatches(), accuracy_->rays_checked);
  return verdict;
}

}  // namespace raymeter
