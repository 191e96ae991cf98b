#pragma once

// Sixteen bytes as a table that is looked up sixteen times at once. As Lanes, a specialisation for each instruction set.

#include <cstdint>

#include "core/simd/lanes.h"

namespace raymeter {

/// `narrow` makes bytes of Bytes<I>::kLanes registers of numbers in 0..127, side by side. `lookup` gives table[index] byte by byte; what it gives where an
/// index is above 15 means nothing. `zeros` are the bytes that are 0, as bits.
template <Isa I>
struct Bytes;

template <>
struct Bytes<Isa::scalar> {
  struct Vector {
    std::uint8_t byte[16];
  };
  using Int = Lanes<Isa::scalar>::Int;
  static constexpr int kLanes = 16;

  static Vector narrow(const Int* lanes) noexcept {
    Vector to;
    for (int i = 0; i < 16; ++i) to.byte[i] = static_cast<std::uint8_t>(lanes[i].value);
    return to;
  }
  static Vector load(const std::uint8_t* p) noexcept {
    Vector to;
    for (int i = 0; i < 16; ++i) to.byte[i] = p[i];
    return to;
  }
  static Vector lookup(Vector table, Vector index) noexcept {
    for (std::uint8_t& i : index.byte) i = table.byte[i & 15];
    return index;
  }
  static Vector both(Vector a, Vector b) noexcept {
    for (int i = 0; i < 16; ++i) a.byte[i] &= b.byte[i];
    return a;
  }
  static std::uint32_t zeros(Vector a) noexcept {
    std::uint32_t bits = 0;
    for (int i = 0; i < 16; ++i) bits |= (a.byte[i] == 0 ? 1u : 0u) << i;
    return bits;
  }
};

#ifdef __SSE4_2__
/// What the vector instruction sets share: bytes of 128 bits.
template <Isa I>
struct Bytes128 {
  using Vector = __m128i;
  using Int = typename Lanes<I>::Int;
  static constexpr int kLanes = 16 / Lanes<I>::kWidth;

  static Vector load(const std::uint8_t* p) noexcept { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(p)); }
  static Vector lookup(Vector table, Vector index) noexcept { return _mm_shuffle_epi8(table, index); }
  static Vector both(Vector a, Vector b) noexcept { return _mm_and_si128(a, b); }
  static std::uint32_t zeros(Vector a) noexcept { return static_cast<std::uint32_t>(_mm_movemask_epi8(_mm_cmpeq_epi8(a, _mm_setzero_si128()))); }
};

template <>
struct Bytes<Isa::sse42> : Bytes128<Isa::sse42> {
  static Vector narrow(const Int* lanes) noexcept { return _mm_packus_epi16(_mm_packs_epi32(lanes[0], lanes[1]), _mm_packs_epi32(lanes[2], lanes[3])); }
};
#endif

#if defined(__AVX2__) && defined(__FMA__)
template <>
struct Bytes<Isa::avx2> : Bytes128<Isa::avx2> {
  static Vector narrow(const Int* lanes) noexcept {
    const __m256i pairs = _mm256_permute4x64_epi64(_mm256_packs_epi32(lanes[0], lanes[1]), 0xD8);  // the instruction packs halves
    return _mm_packus_epi16(_mm256_castsi256_si128(pairs), _mm256_extracti128_si256(pairs, 1));
  }
};
#endif

#ifdef __AVX512DQ__
template <>
struct Bytes<Isa::avx512> : Bytes128<Isa::avx512> {
  static Vector narrow(const Int* lanes) noexcept { return _mm512_cvtepi32_epi8(lanes[0]); }
};
#endif

}  // namespace raymeter
