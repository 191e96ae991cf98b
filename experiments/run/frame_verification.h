#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "experiments/config/config.h"
#include "experiments/image/image_error.h"
#include "experiments/run/pass.h"
#include "experiments/verify/verify.h"

namespace raymeter {

/// What verification says of an image.
struct FrameVerdict {
  std::string complaint;        ///< empty where it is right
  std::int64_t mismatches = 0;  ///< pixels that differ from the reference's
  ImageError error;             ///< against the reference's image that is cut nowhere
  std::int64_t rays_full = 0;   ///< of that image
  BoundCheck bound;             ///< the error beside what was promised
};

/// Holds the images of one instruction set and one greatest depth, bit for bit, against those that a reference technique makes with the same least weights. The
/// exact oracle judges the reference by eye rays, their shadow rays and their mirrored rays: images are the same where hits are.
class FrameVerification {
public:
  /// `oracle` may be null: no exact check.
  FrameVerification(const Oracle* oracle, const Frame& frame, Intersector& reference, const VerifyOptions& options, std::uint64_t seed);
  /// An image with that least weight, and what was promised of its pixels.
  [[nodiscard]] FrameVerdict judge(const Answers& answers, double min_weight, const Column<glm::vec3>& bound);
  /// What the oracle says of the reference.
  [[nodiscard]] const std::optional<Accuracy>& accuracy() const noexcept { return accuracy_; }

private:
  struct Reference {
    Answers answers;
    std::int64_t rays = 0;
  };
  const Reference& reference(double min_weight);
  void ask_oracle(const Oracle& oracle, std::uint64_t seed);

  Frame frame_;
  Intersector& tracer_;
  VerifyOptions options_;
  std::map<double, Reference> references_;  ///< by least weight
  std::optional<Accuracy> accuracy_;
};

}  // namespace raymeter
