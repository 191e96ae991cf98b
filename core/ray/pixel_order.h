#pragma once

#include <algorithm>
#include <cstdint>

#include "core/base/column.h"

namespace raymeter {

/// The order of eye rays: blocks of 16x16 pixels row by row; in a block, tiles of 4x4 pixels row by row; in a tile, pixels row by row. Sixteen rays in a row
/// see 4x4 pixels, 256 see 16x16: packets of any size are compact. Blocks at the right and lower border are cut off.
class PixelOrder {
public:
  static constexpr int kBlock = 16;
  static constexpr int kTile = 4;

  PixelOrder(int width, int height) noexcept : width_(width), height_(height), blocks_across_((width + kBlock - 1) / kBlock) {}

  [[nodiscard]] std::int32_t block_count() const noexcept { return blocks_across_ * ((height_ + kBlock - 1) / kBlock); }
  /// Appends the pixel indices, y * width + x, of one block.
  void append_block(std::int32_t block, Column<std::int32_t>& pixels) const {
    const int left = block % blocks_across_ * kBlock;
    const int top = block / blocks_across_ * kBlock;
    for (int tile = 0; tile < kBlock * kBlock / (kTile * kTile); ++tile) {
      const int x0 = left + tile % (kBlock / kTile) * kTile;
      const int y0 = top + tile / (kBlock / kTile) * kTile;
      for (int y = y0; y < std::min(y0 + kTile, height_); ++y) {
        for (int x = x0; x < std::min(x0 + kTile, width_); ++x) pixels.push_back(y * width_ + x);
      }
    }
  }

private:
  int width_;
  int height_;
  int blocks_across_;
};

}  // namespace raymeter
