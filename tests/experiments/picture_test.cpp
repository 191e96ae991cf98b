#include "experiments/image/picture.h"

#include <gtest/gtest.h>

namespace raymeter {
namespace {

TEST(Picture, ShowsRadianceFromZeroToOneWithoutGamma) {
  Image image{2, 2, {}};
  for (const glm::vec3& p : {glm::vec3(0, 0.5, 1), glm::vec3(0.078, 0.361, 0.753), glm::vec3(-1, 2, 1e30), glm::vec3(1.0f / 255)}) image.pixel.push_back(p);
  const Picture picture = to_picture(image);
  EXPECT_EQ(picture.rgb, (std::vector<std::uint8_t>{0, 128, 255, 20, 92, 192, 0, 255, 255, 1, 1, 1}));
}

TEST(Picture, HeatRunsFromDarkBlueToYellow) {
  const std::vector<std::uint64_t> counts{0, 50, 100, 25, 0, 75};
  const Picture picture = heat_picture(3, 2, counts, 100);
  EXPECT_EQ((std::vector<std::uint8_t>{picture.rgb.begin(), picture.rgb.begin() + 9}), (std::vector<std::uint8_t>{68, 1, 84, 33, 145, 140, 253, 231, 37}));
  const auto luminance = [&](std::size_t i) { return 0.2126 * picture.rgb[3 * i] + 0.7152 * picture.rgb[3 * i + 1] + 0.0722 * picture.rgb[3 * i + 2]; };
  EXPECT_LT(luminance(0), luminance(3));
  EXPECT_LT(luminance(3), luminance(1));
  EXPECT_LT(luminance(1), luminance(5));
  EXPECT_LT(luminance(5), luminance(2));
  const Picture nothing = heat_picture(1, 1, std::vector<std::uint64_t>{0}, 0);
  EXPECT_EQ(nothing.rgb, (std::vector<std::uint8_t>{68, 1, 84})) << "no event anywhere";
}

TEST(Picture, PngHoldsItsSize) {
  const std::string bytes = png_bytes(heat_picture(3, 2, std::vector<std::uint64_t>(6, 1), 1));
  EXPECT_EQ(bytes.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(bytes.substr(16, 8), std::string("\0\0\0\3\0\0\0\2", 8));
}

}  // namespace
}  // namespace raymeter
