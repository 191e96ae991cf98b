#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/render/image.h"

namespace raymeter {

/// 8-bit RGB, rows from the top.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;
};

/// The image as it is shown: [0, 1] to 0..255, what is above is white. No gamma: NFF's colours are display values.
[[nodiscard]] Picture to_picture(const Image& image);
/// Counts in false colours: viridis, violet at 0 to yellow at `most`.
[[nodiscard]] Picture heat_picture(int width, int height, std::span<const std::uint64_t> counts, std::uint64_t most);
/// The picture as a PNG file. Throws std::runtime_error where libpng cannot.
[[nodiscard]] std::string png_bytes(const Picture& picture);

}  // namespace raymeter
