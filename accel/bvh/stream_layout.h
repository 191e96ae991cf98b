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
  float inv_dir[3][2];  ///< and negated
  float interval[2];    ///< t_min, and the negated t of the nearest hit so far; inf where the ray is not to be traced
  float org[3];
  float slack;  ///< of slab intervals, negated: RayPacket::slab_slack
  float shear[3];
  std::int32_t axis;  ///< of the largest |dir|
};
static_assert(sizeof(StreamRay) == 64);

/// A slice's rays sorted by octant.
struct SortedRays {
  StreamRay ray[kStreamRays];
  float t_unit[kStreamRays];         ///< as in RayPacket
  std::int32_t source[kStreamRays];  ///< a ray's number in the slice
  std::int32_t first[9];             ///< of each octant
};

/// Entries of a group's stack: a child and the rays that want it. Registers are stored whole, past the entries that count.
[[nodiscard]] constexpr std::size_t stream_stack_bytes(std::int32_t capacity) noexcept {
  return (static_cast<std::size_t>(capacity) + kWideChildren + 1) / 2 * 2 * (sizeof(std::uint64_t) + sizeof(WideRef));
}

/// Scratch memory of a stream traversal.
[[nodiscard]] constexpr std::size_t stream_bytes(std::int32_t capacity) noexcept { return sizeof(SortedRays) + kInterleaved * stream_stack_bytes(capacity); }

}  // namespace raymeter
