#pragma once

// The traversal stack of a group: children and the rays that want them.

#include "accel/bvh/node_access_kernel.h"
#include "accel/bvh/stream_node_kernel.h"
#include "core/simd/select_kernel.h"

namespace raymeter {

struct StreamStack {
  std::uint64_t* rays;
  WideRef* child;
  std::int32_t size = 0;

  StreamStack() = default;
  StreamStack(std::byte* scratch, std::int32_t capacity) noexcept
      : rays(reinterpret_cast<std::uint64_t*>(scratch)), child(reinterpret_cast<WideRef*>(rays + capacity + kWideChildren)) {}
  [[gnu::always_inline]] void push(WideRef ref, std::uint64_t wanted) noexcept {
    rays[size] = wanted;
    child[size++] = ref;
  }
};

/// Pushes the children that any ray meets, the nearest last; `order` as in WideNode.
template <class L>
[[gnu::always_inline]] inline void push_children(StreamStack& stack, const WideNode& node, std::uint32_t order, const ChildRays<L>& met) noexcept {
  for (int i = kWideChildren - 1; i >= 0; --i) {
    const std::uint32_t place = order >> 4 * i & 7;
    stack.rays[stack.size] = met.rays[place];
    stack.child[stack.size] = node.child[place];
    stack.size += met.rays[place] != 0 ? 1 : 0;
  }
}

#if defined(__AVX2__) && defined(__FMA__)
template <>
[[gnu::always_inline]] inline void push_children<Lanes<Isa::avx2>>(StreamStack& stack, const WideNode& node, std::uint32_t order,
                                                                   const ChildRays<Lanes<Isa::avx2>>& met) noexcept {
  using Shuffles = LaneShuffles<Isa::avx2>;
  const __m256i place = _mm256_srlv_epi32(_mm256_set1_epi32(static_cast<int>(order)), _mm256_setr_epi32(28, 24, 20, 16, 12, 8, 4, 0));  // and what is above it
  const __m256i some = _mm256_permutevar8x32_epi32(_mm256_or_si256(met.lower, met.upper), place);
  const __m256i none = _mm256_cmpeq_epi32(some, _mm256_setzero_si256());
  const auto wanted = static_cast<std::uint32_t>(_mm256_movemask_ps(_mm256_castsi256_ps(none))) ^ 0xFFu;
  const __m256i from = _mm256_permutevar8x32_epi32(place, Shuffles::numbers_of(wanted));
  const __m256i child = _mm256_permutevar8x32_epi32(_mm256_load_si256(reinterpret_cast<const __m256i*>(node.child)), from);
  // Halves are unpacked within halves of a register: what is to come third and fourth has to stand in the upper one.
  const __m256i apart = _mm256_permutevar8x32_epi32(from, _mm256_setr_epi32(0, 1, 4, 5, 2, 3, 6, 7));
  const __m256i lower = _mm256_permutevar8x32_epi32(met.lower, apart), upper = _mm256_permutevar8x32_epi32(met.upper, apart);
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(stack.rays + stack.size), _mm256_unpacklo_epi32(lower, upper));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(stack.rays + stack.size + 4), _mm256_unpackhi_epi32(lower, upper));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(stack.child + stack.size), child);
  stack.size += __builtin_popcount(wanted);
}
#endif

#ifdef __AVX512DQ__
template <>
[[gnu::always_inline]] inline void push_children<Lanes<Isa::avx512>>(StreamStack& stack, const WideNode& node, std::uint32_t order,
                                                                     const ChildRays<Lanes<Isa::avx512>>& met) noexcept {
  const __m512i place = _mm512_srlv_epi64(_mm512_set1_epi64(order), _mm512_setr_epi64(28, 24, 20, 16, 12, 8, 4, 0));
  const __m512i rays = _mm512_permutexvar_epi64(place, met.rays);
  const __m256i child = _mm256_permutexvar_epi32(_mm512_cvtepi64_epi32(place), _mm256_load_si256(reinterpret_cast<const __m256i*>(node.child)));
  const __mmask8 wanted = _mm512_test_epi64_mask(rays, rays);
  _mm512_storeu_si512(stack.rays + stack.size, _mm512_maskz_compress_epi64(wanted, rays));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(stack.child + stack.size), _mm256_maskz_compress_epi32(wanted, child));
  stack.size += __builtin_popcount(wanted);
}
#endif

/// Asks for what a child is, so that it comes from memory while other groups take their turns.
template <class View>
[[gnu::always_inline]] inline void prefetch_child(const View& bvh, WideRef child) noexcept {
  const char* const target = address_of(bvh, child);
  const SphereView& spheres = bvh.pools.spheres;
  if (spheres.prim == nullptr) [[likely]] {
    for (int line = 0; line < 4; ++line) __builtin_prefetch(target + 64 * line);
    return;
  }
  // Of runs of other kinds, which are few beside spheres, something that nobody needs.
  const bool is_run = child.tag() == WideRef::Tag::run;
  const std::int32_t first = bvh.runs[select_unforeseen(is_run, child.index(), 0u)].first;
  const auto prefetch = [is_run](const void* of_run, const char* otherwise) noexcept {
    __builtin_prefetch(select_unforeseen(is_run, static_cast<const char*>(of_run), otherwise));
  };
  for (int a = 0; a < 3; ++a) prefetch(spheres.center[a] + first, target + 64 * a);
  prefetch(spheres.radius + first, target + 192);
  prefetch(spheres.prim + first, target);
}

}  // namespace raymeter
