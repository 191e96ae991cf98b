#pragma once

#include <cstddef>
#include <cstdint>

#include "accel/bvh/wide_layout.h"

namespace raymeter {

/// A wide node whose planes are whole numbers of steps from a corner (Mahovsky, Wyvill 2006, "Memory-conserving bounding volume hierarchies with coherent
/// raytracing"; Ylitie, Karras, Laine 2017): plane p of child c lies at corner[p % 3] + plane[p][c] * 2^exponent[p % 3], rounded to float once. 128 bytes with
/// Plane = std::uint8_t, 192 with std::uint16_t.
template <class Plane>
struct alignas(64) QuantisedNode {
  float corner[3];
  std::int8_t exponent[3];  ///< -126 to 127
  std::uint8_t children;    ///< the first places; the others have empty boxes
  Plane plane[6][kWideChildren];
  WideRef child[kWideChildren];
  std::uint32_t order[8];  ///< as WideNode::order
};
static_assert(sizeof(QuantisedNode<std::uint8_t>) == 128);
static_assert(sizeof(QuantisedNode<std::uint16_t>) == 192);

/// `nodes` of the base class is null.
struct QuantisedBvhView : WideBvhView {
  const std::byte* quantised;  ///< QuantisedNode of std::uint8_t or of std::uint16_t
  std::int32_t plane_bytes;    ///< 1 or 2, accordingly
};

}  // namespace raymeter
