#pragma once

#include <cstdint>
#include <optional>

#include "core/render/image.h"

namespace raymeter {

/// How far an image is from another of the same size.
struct ImageError {
  double rmse = 0;             ///< root of the mean squared difference of radiance, over all pixels and channels
  std::optional<double> ssim;  ///< structural similarity as shown; empty where a side is shorter than its window of 11 pixels

  /// Peak signal-to-noise ratio in decibels, the peak being white, 1; infinite where the images are equal.
  [[nodiscard]] double psnr() const noexcept;
};

/// An image's error beside what was promised of it, over all pixels and channels.
struct BoundCheck {
  double error_mean = 0;
  double error_max = 0;
  double bound_mean = 0;
  double bound_max = 0;
  std::int64_t exceeded = 0;  ///< pixels that are further from the reference than their bound
};

[[nodiscard]] BoundCheck check_bound(const Image& image, const Image& reference, const Column<glm::vec3>& bound);

[[nodiscard]] ImageError image_error(const Image& image, const Image& reference);

}  // namespace raymeter
