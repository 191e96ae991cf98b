#include "experiments/image/picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <png.h>

namespace raymeter {

namespace {

/// Viridis (van der Walt, Smith 2015, CC0) at 17 equal steps, linear between: perceptually uniform, also in print and for the colour-blind.
constexpr std::array<std::array<double, 3>, 17> kViridis{{{68, 1, 84},
                                                          {72, 24, 106},
                                                          {71, 45, 123},
                                                          {66, 64, 134},
                                                          {59, 82, 139},
                                                          {51, 99, 141},
                                                          {44, 114, 142},
                                                          {38, 130, 142},
                                                          {33, 145, 140},
                                                          {31, 160, 136},
                                                          {40, 174, 128},
                                                          {63, 188, 115},
                                                          {94, 201, 98},
                                                          {132, 212, 75},
                                                          {173, 220, 48},
                                                          {216, 226, 25},
                                                          {253, 231, 37}}};

Picture blank(int width, int height) {
  return {width, height, std::vector<std::uint8_t>(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height))};
}

}  // namespace

Picture to_picture(const Image& image) {
  Picture picture = blank(image.width, image.height);
  for (std::size_t i = 0; i < image.pixel.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const float value = image.pixel[i][static_cast<glm::length_t>(c)];
      picture.rgb[3 * i + c] = static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0f, 1.0f)));
    }
  }
  return picture;
}

Picture heat_picture(int width, int height, std::span<const std::uint64_t> counts, std::uint64_t most) {
  Picture picture = blank(width, height);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double share = most > 0 ? std::min(1.0, static_cast<double>(counts[i]) / static_cast<double>(most)) : 0.0;
    const double place = share * (kViridis.size() - 1);
    const std::size_t step = std::min(static_cast<std::size_t>(place), kViridis.size() - 2);
    for (std::size_t c = 0; c < 3; ++c) {
      picture.rgb[3 * i + c] = static_cast<std::uint8_t>(std::lround(std::lerp(kViridis[step][c], kViridis[step + 1][c], place - static_cast<double>(step))));
    }
  }
  return picture;
}

std::string png_bytes(const Picture& picture) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(picture.width);
  png.height = static_cast<png_uint_32>(picture.height);
  png.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&png, bytes.data(), &size, 0, picture.rgb.data(), 0, nullptr) == 0) {
    throw std::runtime_error(std::string("PNG: ") + png.message);
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace raymeter
