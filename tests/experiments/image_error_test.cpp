#include "experiments/image/image_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace raymeter {
namespace {

Image waves(int width, int height, bool disturbed) {
  Image image{width, height, Column<glm::vec3>(static_cast<std::size_t>(width * height))};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < 3; ++c) {
        auto value = static_cast<float>(0.5 + 0.6 * std::sin(0.3 * x + 0.7 * y + c));
        if (disturbed) value += static_cast<float>(0.1 * std::cos(1.1 * x - 0.4 * y + 2 * c));
        image.pixel[static_cast<std::size_t>(y * width + x)][c] = value;
      }
    }
  }
  return image;
}

TEST(ImageError, IsThatOfScikitImage) {
  // skimage 0.19.3: mean_squared_error, peak_signal_noise_ratio(data_range=1), and of the images clipped to [0, 1]
  // structural_similarity(data_range=1, gaussian_weights=True, sigma=1.5, use_sample_covariance=False, channel_axis=2).
  const ImageError error = image_error(waves(24, 17, true), waves(24, 17, false));
  EXPECT_NEAR(error.rmse, 0.07071808955092755, 1e-8);
  EXPECT_NEAR(error.psnr(), 23.009389606024428, 1e-6);
  ASSERT_TRUE(error.ssim.has_value());
  EXPECT_NEAR(*error.ssim, 0.9860704919157387, 1e-8);
}

TEST(ImageError, IsNoneBetweenEqualImages) {
  const ImageError error = image_error(waves(11, 11, true), waves(11, 11, true));
  EXPECT_EQ(error.rmse, 0);
  EXPECT_EQ(error.psnr(), std::numeric_limits<double>::infinity());
  ASSERT_TRUE(error.ssim.has_value());
  EXPECT_NEAR(*error.ssim, 1, 1e-12);
}

TEST(ImageError, HasNoSimilarityWhereNoWindowFits) {
  EXPECT_FALSE(image_error(waves(10, 40, true), waves(10, 40, false)).ssim.has_value());
  EXPECT_GT(image_error(waves(10, 40, true), waves(10, 40, false)).rmse, 0.05);
  EXPECT_EQ(image_error({}, {}).rmse, 0);
}

}  // namespace
}  // namespace raymeter
