#pragma once

// A group's rays against the eight children of a node: children in lanes, one ray after the other, by the slab test of core/bounds/slab_kernel.h. All rays
// have the same direction signs, so that a node's near and far planes are told apart once for all of them. The far side is negated: one maximum serves both.

#include "accel/bvh/stream_ray_kernel.h"
#include "accel/bvh/wide_layout.h"
#include "core/simd/shuffle_kernel.h"

namespace raymeter {

/// By child: the rays that meet its box, as bits.
template <class L>
struct alignas(64) ChildRays {
  std::uint64_t rays[kWideChildren];
};

/// Ray i of a group as a bit, in two halves.
struct RayBits {
  std::int32_t half[64][2];
};
[[nodiscard]] constexpr RayBits ray_bits() noexcept {
  RayBits bits{};
  for (int i = 0; i < 64; ++i) bits.half[i][i / 32] = static_cast<std::int32_t>(1u << i % 32);
  return bits;
}
inline constexpr RayBits kRayBits = ray_bits();

/// The children's planes across an axis that rays of an octant meet first; those of the opposite octant they meet last. Turns go from octant to octant, so that
/// nothing branches on it.
[[nodiscard, gnu::always_inline]] inline const float* first_planes(const WideNode& node, std::uint32_t octant, int axis) noexcept {
  return node.plane[axis + 3 * static_cast<int>(octant >> axis & 1)];
}

/// The planes that rays of an octant meet first and last, in registers.
template <class L>
struct NodePlanes {
  using Float = typename L::Float;
  static constexpr int kRegisters = L::kWidth < kWideChildren ? kWideChildren / L::kWidth : 1;
  Float first[kRegisters][3];
  Float last[kRegisters][3];

  NodePlanes(const WideNode& node, std::uint32_t octant) noexcept {
    for (int r = 0; r < kRegisters; ++r) {
      for (int a = 0; a < 3; ++a) {
        first[r][a] = L::load(first_planes(node, octant, a) + r * L::kWidth);
        last[r][a] = L::load(first_planes(node, ~octant, a) + r * L::kWidth);
      }
    }
  }
  /// The children of register `r` whose boxes the ray meets before its hit.
  [[gnu::always_inline]] typename L::Mask met(const StreamRay& ray, int r) const noexcept {
    Float enter(ray.interval[0]), leave(ray.interval[1]);  // leave is negated
    for (int a = 0; a < 3; ++a) {
      const Float org(ray.org[a]);
      enter = L::max((first[r][a] - org) * Float(ray.inv_dir[a][0]), enter);
      leave = L::max((last[r][a] - org) * Float(ray.inv_dir[a][1]), leave);
    }
    return enter + leave <= Float(ray.slack);
  }
};

template <class L>
[[gnu::always_inline]] inline ChildRays<L> rays_of_children(const WideNode& node, std::uint32_t octant, const StreamRay* ray, std::uint64_t wanted) noexcept {
  using Int = typename L::Int;
  const NodePlanes<L> planes(node, octant);
  ChildRays<L> met{};
  for (int half = 0; half < 2; ++half) {
    Int bits[NodePlanes<L>::kRegisters];
    for (Int& b : bits) b = Int(0);
    for (std::uint32_t left = static_cast<std::uint32_t>(wanted >> 32 * half); left != 0; left &= left - 1) {
      const StreamRay& one = ray[32 * half + __builtin_ctz(left)];
      const Int bit(static_cast<std::int32_t>(left & -left));
      for (int r = 0; r < NodePlanes<L>::kRegisters; ++r) bits[r] = bits[r] + L::select(planes.met(one, r), bit, Int(0));
    }
    alignas(64) std::int32_t half_mask[kWideChildren];
    for (int r = 0; r < NodePlanes<L>::kRegisters; ++r) L::store(half_mask + r * L::kWidth, bits[r]);
    for (int c = 0; c < kWideChildren; ++c) met.rays[c] |= std::uint64_t{static_cast<std::uint32_t>(half_mask[c])} << 32 * half;
  }
  return met;
}

#if defined(__AVX2__) && defined(__FMA__)
/// Eight lanes: the lower and the upper halves of the masks in a register each, by one loop over the rays: how often a loop turns no branch foresees.
template <>
struct ChildRays<Lanes<Isa::avx2>> {
  __m256i lower, upper;
};

template <>
[[gnu::always_inline]] inline ChildRays<Lanes<Isa::avx2>> rays_of_children<Lanes<Isa::avx2>>(const WideNode& node, std::uint32_t octant, const StreamRay* ray,
                                                                                             std::uint64_t wanted) noexcept {
  const NodePlanes<Lanes<Isa::avx2>> planes(node, octant);
  __m256i lower = _mm256_setzero_si256(), upper = _mm256_setzero_si256();
  for (; wanted != 0; wanted &= wanted - 1) {
    const int i = __builtin_ctzll(wanted);
    const __m256i inside = _mm256_castps_si256(planes.met(ray[i], 0));
    lower = _mm256_or_si256(lower, _mm256_and_si256(inside, _mm256_set1_epi32(kRayBits.half[i][0])));
    upper = _mm256_or_si256(upper, _mm256_and_si256(inside, _mm256_set1_epi32(kRayBits.half[i][1])));
  }
  return {lower, upper};
}
#endif

#ifdef __AVX512DQ__
template <>
struct ChildRays<Lanes<Isa::avx512>> {
  __m512i rays;
};

/// Sixteen lanes: near and far planes of eight children in turn, so that one register does it all; a mask of pairs of lanes is one of 64-bit integers.
template <>
[[gnu::always_inline]] inline ChildRays<Lanes<Isa::avx512>> rays_of_children<Lanes<Isa::avx512>>(const WideNode& node, std::uint32_t octant,
                                                                                                 const StreamRay* ray, std::uint64_t wanted) noexcept {
  using L = Lanes<Isa::avx512>;
  using Shuffles = LaneShuffles<Isa::avx512>;
  using Float = L::Float;
  Float plane[3];
  for (int a = 0; a < 3; ++a) plane[a] = Shuffles::interleave(first_planes(node, octant, a), first_planes(node, ~octant, a));
  __m512i met = _mm512_setzero_si512();
  for (; wanted != 0; wanted &= wanted - 1) {
    const StreamRay& one = ray[__builtin_ctzll(wanted)];
    Float ends = Shuffles::repeat_pair(one.interval);
    for (int a = 0; a < 3; ++a) ends = L::max((plane[a] - Float(one.org[a])) * Shuffles::repeat_pair(one.inv_dir[a]), ends);
    const __mmask16 inside = L::Mask(ends + Shuffles::swap_in_pairs(ends) <= Float(one.slack));
    met = _mm512_mask_or_epi32(met, inside, met, _mm512_set1_epi64(static_cast<long long>(wanted & -wanted)));
  }
  return {met};
}
#endif

}  // namespace raymeter
