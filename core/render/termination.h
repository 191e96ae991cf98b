#pragma once

namespace raymeter {

/// When a ray is followed no further. Data, not a class: the eye ray has depth 1 and weight 1.
struct Termination {
  int max_depth = 5;
  /// Adaptive depth control (Hall, Greenberg 1983, IEEE CG&A 3(8)): a reflection or refraction ray whose radiance counts for less than this share of its pixel
  /// is not traced. 0 cuts nothing, not even rays of weight 0; above 1 only eye rays are left.
  double min_weight = 0;

  [[nodiscard]] constexpr bool traces_eye_rays() const noexcept { return max_depth >= 1; }
  [[nodiscard]] constexpr bool follows(int depth, double weight) const noexcept { return depth <= max_depth && weight >= min_weight; }
};

}  // namespace raymeter
