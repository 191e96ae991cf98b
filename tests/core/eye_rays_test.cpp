#include <gtest/gtest.h>

#include <set>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "core/base/column.h"
#include "core/ray/pixel_order.h"
#include "core/scene/camera.h"

namespace raymeter {
namespace {

TEST(EyeRays, SamplesLieWhereEachConventionPutsThem) {
  // Looking down -z with a half angle of 45 degrees, x / -z is the sample's place in units of tan(fov / 2).
  const Camera camera{{0, 0, 0}, {0, 0, -7}, {0, 3, 1}, 90, 0, 512, 512};
  const auto place = [&](CameraConvention convention, int n, int x, int y) {
    const glm::dvec3 d = EyeRays({camera, convention, n, n}).direction(x, y);
    return glm::dvec2(d.x / -d.z, d.y / -d.z);
  };
  const double tolerance = 1e-15 * 4;  // a few roundings in double
  EXPECT_NEAR(place(CameraConvention::spd, 513, 0, 256).x, -512.0 / 511, tolerance);
  EXPECT_NEAR(place(CameraConvention::spd, 513, 512, 0).x, 512.0 / 511, tolerance);
  EXPECT_NEAR(place(CameraConvention::spd, 513, 512, 0).y, 512.0 / 511, tolerance) << "row 0 is at the top";
  EXPECT_NEAR(place(CameraConvention::havran, 513, 0, 512).x, -1, tolerance);
  EXPECT_NEAR(place(CameraConvention::havran, 513, 0, 512).y, -1, tolerance);
  EXPECT_NEAR(place(CameraConvention::pixel, 512, 0, 0).x, -511.0 / 512, tolerance);
  EXPECT_NEAR(place(CameraConvention::pixel, 512, 256, 0).x, 1.0 / 512, tolerance);
  EXPECT_NEAR(place(CameraConvention::spd, 513, 256, 256).x, 0, tolerance);
}

TEST(EyeRays, DegenerateViewsAndTinyImagesStillGiveUnitDirections) {
  for (const CameraConvention convention : {CameraConvention::spd, CameraConvention::havran, CameraConvention::pixel}) {
    for (const int n : {1, 2, 3}) {
      for (const Camera& camera : {Camera{{1, 1, 1}, {1, 1, 1}, {0, 1, 0}}, Camera{{0, 0, 0}, {0, 5, 0}, {0, 1, 0}}, Camera{{0, 0, 0}, {1, 0, 0}, {0, 0, 0}}}) {
        EXPECT_NEAR(glm::length(EyeRays({camera, convention, n, n}).direction(0, n - 1)), 1, 1e-15);
      }
    }
  }
}

TEST(PixelOrder, MeetsEveryPixelOnceInTilesOfSixteen) {
  for (const auto& [width, height] : {std::pair{64, 48}, std::pair{513, 17}, std::pair{1, 1}, std::pair{3, 100}}) {
    const PixelOrder order(width, height);
    Column<std::int32_t> pixels;
    for (std::int32_t block = 0; block < order.block_count(); ++block) order.append_block(block, pixels);
    ASSERT_EQ(pixels.size(), static_cast<std::size_t>(width * height));
    EXPECT_EQ(std::set<std::int32_t>(pixels.begin(), pixels.end()).size(), pixels.size());
    if (width % 16 != 0 || height % 16 != 0) continue;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const std::int32_t first = pixels[i / 16 * 16];
      EXPECT_EQ(pixels[i] % width / 4, first % width / 4);
      EXPECT_EQ(pixels[i] / width / 4, first / width / 4);
    }
  }
}

}  // namespace
}  // namespace raymeter
