#pragma once

#include <cstdint>

#include "core/scene/primitive.h"

namespace raymeter {

struct Aabb;

inline constexpr int kMaxBins = 64;

/// Four floats in one register, as the GNU dialect has them.
using Row4 = float __attribute__((vector_size(16)));

/// Box of rows; the fourth elements are free for other use.
struct Box4 {
  Row4 min;
  Row4 max;
};
inline constexpr float kInfinite = __builtin_inff();
inline constexpr Box4 kEmptyBox4{{kInfinite, kInfinite, kInfinite, kInfinite}, {-kInfinite, -kInfinite, -kInfinite, -kInfinite}};

/// The box of a primitive or of a part of one, and in the fourth row elements which primitive it is: patterns of numbers that are not denormal, which would be
/// slow to calculate with. The sign bits hold the kind.
struct BinnedBox {
  Box4 box;
  BinnedBox() = default;
  inline BinnedBox(const Aabb& around, PrimRef prim) noexcept;
  [[nodiscard]] inline PrimRef prim() const noexcept;
  [[nodiscard]] inline Aabb aabb() const noexcept;

private:
  static constexpr std::uint32_t kNormal = 0x40000000;
};

/// Maps centres to bins; axes without extent map to bin 0 and are never split.
struct BinMapping {
  int bins;
  Row4 offset;
  Row4 scale;
  BinMapping(const Box4& centers2, int bin_count) noexcept : bins(bin_count) {
    offset = centers2.min;
    for (int a = 0; a < 4; ++a) {
      const float extent = centers2.max[a] - centers2.min[a];
      const float factor = static_cast<float>(bins) * 0.99999f / extent;
      scale[a] = a < 3 && extent > 0 && factor < kInfinite ? factor : 0.0f;
    }
  }
};

/// On each axis the boxes of bins, and how many boxes begin and end in them: of splits by centres, all in one.
struct alignas(64) Bins {
  Box4 box[3][kMaxBins];
  std::int32_t entering[3][kMaxBins];
  std::int32_t leaving[3][kMaxBins];
  void clear(int bins) noexcept;  ///< the others are not looked at
  void add(const Bins& other, int bins) noexcept;
};

}  // namespace raymeter
