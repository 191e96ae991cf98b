#pragma once

// What a beam meets of a wide node and of a block of triangles.

#include "accel/beam_kernel.h"
#include "accel/bvh/wide_layout.h"
#include "core/simd/bytes_kernel.h"

namespace raymeter {

/// Which of a node's children the beam meets before the plane `farthest`, as bits.
template <class L>
inline std::uint32_t children_met(const Beam& beam, const WideNode& node, float farthest) noexcept {
  using Float = typename L::Float;
  constexpr int kStep = L::kWidth < kWideChildren ? L::kWidth : kWideChildren;
  const float* const least = node.plane[beam.axis];
  const float* const greatest = node.plane[beam.axis + 3];
  std::uint32_t met = 0;
  for (int c = 0; c < kWideChildren; c += kStep) {  // a wider register reads on into the next row, to no effect
    auto inside = (L::load(least + c) <= Float(beam.greatest(farthest))) & (L::load(greatest + c) >= Float(beam.least(farthest)));
    for (int i = 0; i < 2; ++i) {
      const int a = beam.across[i];
      const BeamLine &low = beam.low[i], &high = beam.high[i];
      const float* const lowest = low.slope >= 0 ? least : greatest;
      const float* const highest = high.slope >= 0 ? greatest : least;
      inside = inside & (L::load(node.plane[a + 3] + c) >= L::mul_add(Float(low.slope), L::load(lowest + c), Float(low.at_zero))) &
               (L::load(node.plane[a] + c) <= L::mul_add(Float(high.slope), L::load(highest + c), Float(high.at_zero)));
    }
    met |= (L::bits(inside) & ((1u << kStep) - 1)) << c;
  }
  return met;
}

/// The block's triangles that are not wholly outside one side of the beam, as bits.
template <class L>
inline std::uint32_t triangles_met(const Beam& beam, const TriangleBlock& block, float farthest) noexcept {
  using Float = typename L::Float;
  using Int = typename L::Int;
  using Sides = Bytes<L::kIsa>;
  Int outside[Sides::kLanes];
  const Int zero(0);
  for (int g = 0; g < Sides::kLanes; ++g) {  // the last vertices are what follows in the block, to no effect
    const int v = g * L::kWidth;
    const Float c = L::load(block.vertex[beam.axis] + v);
    Int sides = L::select(c > Float(beam.greatest(farthest)), Int(1), zero) + L::select(c < Float(beam.least(farthest)), Int(2), zero);
    for (int i = 0; i < 2; ++i) {
      const Float x = L::load(block.vertex[beam.across[i]] + v);
      sides = sides + L::select(x < L::mul_add(Float(beam.low[i].slope), c, Float(beam.low[i].at_zero)), Int(4 << 2 * i), zero);
      sides = sides + L::select(x > L::mul_add(Float(beam.high[i].slope), c, Float(beam.high[i].at_zero)), Int(8 << 2 * i), zero);
    }
    outside[g] = sides;
  }
  const auto table = Sides::narrow(outside);
  const auto of_corner = [&](int k) noexcept { return Sides::lookup(table, Sides::load(block.corner[k])); };
  return Sides::zeros(Sides::both(Sides::both(of_corner(0), of_corner(1)), of_corner(2))) & ((1u << block.count) - 1);
}

}  // namespace raymeter
