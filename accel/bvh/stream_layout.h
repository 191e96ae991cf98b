#pragma once

#include <cstddef>
#include <cstdint>

#include "accel/bvh/wide_layout.h"
#include "core/ray/views.h"

namespace raymeter {

/// Rays of a slice that are sorted together.
inline constexpr std::int32_t kStreamRays = 1024;

/// Groups that are taken through the hierarchy in turns, a node each, so that what one needs next comes from memory meanwhile.
inline constexpr int kInterleaved = 8;

/// What the tests of nodes and blocks need of one ray, in a cache line.
struct alignas(64) StreamRay {
  float inv_dir[3][2];  ///< times 1 - kSlabPadding; negated, times 1 + kSlabPadding: the fourth rounding of a slab test
  float interval[2];    ///< t_min, and the negated t of the nearest hit so far; inf where the ray is not to be traced
  float org[3];
  float slack;     ///< of slab intervals: twice RayPacket::slab_slack
  float shear[3];  ///< as RayPacket::shear
  float unused;
};
static_assert(sizeof(StreamRay) == 64);

/// What the tests of spheres need of one ray besides, as in RayPacket.
struct alignas(32) StreamLine {
  float dir[3];
  float inv_length2;
  float inv_dir[3];
  float unused;
};
static_assert(sizeof(StreamLine) == 32);

/// Rays of a group agree in the octant of their directions and in the axis of the largest |dir|.
inline constexpr int kStreamBins = 24;

/// The axes that a group's rays see vertices on: p and q across, r along, that of the largest |dir|.
struct StreamAxes {
  int p, q, r;
};
[[nodiscard]] constexpr StreamAxes axes_of_bin(std::uint32_t bin) noexcept {
  const int r = static_cast<int>(bin >> 3);
  return {r == 2 ? 0 : r + 1, r == 0 ? 2 : r - 1, r};
}
[[nodiscard]] constexpr std::uint32_t octant_of_bin(std::uint32_t bin) noexcept { return bin & 7; }

/// A slice's rays sorted by bin.
struct SortedRays {
  StreamRay ray[kStreamRays];
  StreamLine line[kStreamRays];         ///< where the hierarchy has spheres
  float t_unit[kStreamRays];            ///< as in RayPacket
  std::int32_t source[kStreamRays];     ///< a ray's number in the slice
  std::int32_t first[kStreamBins + 1];  ///< of each bin
};

/// Entries of a group's stack: a child and the rays that want it. Registers are stored whole, past the entries that count.
[[nodiscard]] constexpr std::size_t stream_stack_bytes(std::int32_t capacity) noexcept {
  return (static_cast<std::size_t>(capacity) + kWideChildren + 1) / 2 * 2 * (sizeof(std::uint64_t) + sizeof(WideRef));
}

/// Scratch memory of a stream traversal.
[[nodiscard]] constexpr std::size_t stream_bytes(std::int32_t capacity) noexcept { return sizeof(SortedRays) + kInterleaved * stream_stack_bytes(capacity); }

}  // namespace raymeter
