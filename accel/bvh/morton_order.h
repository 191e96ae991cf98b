#pragma once

#include <cstdint>
#include <vector>

#include "accel/bvh/build_prims.h"

namespace raymeter {

/// A primitive's place on the Morton curve through the scene.
struct MortonPrim {
  std::uint64_t code;  ///< 21 bits an axis, x in the lowest
  std::int32_t prim;   ///< index in what was given
  friend bool operator<(const MortonPrim& a, const MortonPrim& b) noexcept { return a.code != b.code ? a.code < b.code : a.prim < b.prim; }
};

/// Primitives by the Morton code of their box's centre, each axis of the centres' bounds cut into 2^21; equal codes in the order given. Runs in the caller's
/// task arena.
[[nodiscard]] std::vector<MortonPrim> build_morton_order(const std::vector<BuildPrim>& prims);

}  // namespace raymeter
