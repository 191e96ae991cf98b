#pragma once

// Moves between lanes, for kernels whose lanes are children of a node or triangles of a leaf instead of rays. A specialisation for each instruction set that
// has them, as with Lanes; kernels do without where there is none.

#include <cstdint>

#include "core/simd/lanes.h"

namespace raymeter {

template <Isa I>
struct LaneShuffles;

#if defined(__AVX2__) && defined(__FMA__)
/// By byte: the numbers of the bits that are set, in order, then 0.
struct BitNumbers {
  std::uint8_t number[256][8];
};
[[nodiscard]] constexpr BitNumbers bit_numbers() noexcept {
  BitNumbers table{};
  for (int byte = 0; byte < 256; ++byte) {
    int count = 0;
    for (int bit = 0; bit < 8; ++bit) {
      if ((byte >> bit & 1) != 0) table.number[byte][count++] = static_cast<std::uint8_t>(bit);
    }
  }
  return table;
}
inline constexpr BitNumbers kBitNumbers = bit_numbers();

template <>
struct LaneShuffles<Isa::avx2> {
  using Float = Lanes<Isa::avx2>::Float;
  using Int = Lanes<Isa::avx2>::Int;

  /// Lane i is element index[i] & 15 of the table.
  static Float permute(const Float (&table)[2], Int index) noexcept {
    const __m256 in_second = _mm256_castsi256_ps(_mm256_slli_epi32(index, 28));
    return _mm256_blendv_ps(_mm256_permutevar8x32_ps(table[0], index), _mm256_permutevar8x32_ps(table[1], index), in_second);
  }
  /// 8 bytes as integers.
  static Int load_bytes(const std::uint8_t* p) noexcept { return _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(p))); }
  /// The numbers of the lanes that are bits of a byte, in order, then 0: what compresses a register by a permutation.
  static Int numbers_of(std::uint32_t byte) noexcept { return load_bytes(kBitNumbers.number[byte]); }
  /// Lanes 0 to 7.
  static void store_eight(float* p, Float v) noexcept { _mm256_storeu_ps(p, v); }
  /// Lane i of row j becomes lane j of row i.
  static void transpose(Float (&row)[8]) noexcept {
    __m256 pair[8], quad[8];
    for (int i = 0; i < 8; i += 2) {
      pair[i] = _mm256_unpacklo_ps(row[i], row[i + 1]);
      pair[i + 1] = _mm256_unpackhi_ps(row[i], row[i + 1]);
    }
    for (int i = 0; i < 8; i += 4) {
      for (int h = 0; h < 2; ++h) {
        quad[i + 2 * h] = _mm256_shuffle_ps(pair[i + h], pair[i + h + 2], 0x44);
        quad[i + 2 * h + 1] = _mm256_shuffle_ps(pair[i + h], pair[i + h + 2], 0xEE);
      }
    }
    for (int i = 0; i < 4; ++i) {
      row[i] = _mm256_permute2f128_ps(quad[i], quad[i + 4], 0x20);
      row[i + 4] = _mm256_permute2f128_ps(quad[i], quad[i + 4], 0x31);
    }
  }
};
#endif

#ifdef __AVX512DQ__
template <>
struct LaneShuffles<Isa::avx512> {
  using L = Lanes<Isa::avx512>;
  using Float = L::Float;
  using Int = L::Int;
  using Mask = L::Mask;

  /// a[0], b[0], a[1], b[1], ..., a[7], b[7]
  static Float interleave(const float* a, const float* b) noexcept {
    const __m512i order = _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
    return _mm512_permutex2var_ps(_mm512_castps256_ps512(_mm256_loadu_ps(a)), order, _mm512_castps256_ps512(_mm256_loadu_ps(b)));
  }
  /// p[0], p[1], p[0], p[1], ...
  static Float repeat_pair(const float* p) noexcept {
    double pair;
    __builtin_memcpy(&pair, p, sizeof pair);
    return _mm512_castpd_ps(_mm512_set1_pd(pair));
  }
  static Float swap_in_pairs(Float a) noexcept { return _mm512_permute_ps(a, 0xB1); }
  /// Lane i is element index[i] & 15 of the table.
  static Float permute(const Float (&table)[1], Int index) noexcept { return _mm512_permutexvar_ps(index, table[0]); }
  /// Lanes 0 to 7.
  static void store_eight(float* p, Float v) noexcept { _mm256_storeu_ps(p, _mm512_castps512_ps256(v)); }
  /// Lane i of row j becomes lane j of row i.
  static void transpose(Float (&row)[16]) noexcept {
    __m512 a[16], b[16];
    for (int i = 0; i < 16; i += 2) {
      a[i] = _mm512_unpacklo_ps(row[i], row[i + 1]);
      a[i + 1] = _mm512_unpackhi_ps(row[i], row[i + 1]);
    }
    for (int i = 0; i < 16; i += 4) {
      for (int h = 0; h < 2; ++h) {
        b[i + 2 * h] = _mm512_shuffle_ps(a[i + h], a[i + h + 2], 0x44);
        b[i + 2 * h + 1] = _mm512_shuffle_ps(a[i + h], a[i + h + 2], 0xEE);
      }
    }
    for (int i = 0; i < 4; ++i) {  // quarters of b[i], b[i + 4], b[i + 8], b[i + 12] are those of rows i, i + 4, i + 8, i + 12
      const __m512 low = _mm512_shuffle_f32x4(b[i], b[i + 4], 0x88), low_odd = _mm512_shuffle_f32x4(b[i], b[i + 4], 0xDD);
      const __m512 high = _mm512_shuffle_f32x4(b[i + 8], b[i + 12], 0x88), high_odd = _mm512_shuffle_f32x4(b[i + 8], b[i + 12], 0xDD);
      row[i] = _mm512_shuffle_f32x4(low, high, 0x88);
      row[i + 8] = _mm512_shuffle_f32x4(low, high, 0xDD);
      row[i + 4] = _mm512_shuffle_f32x4(low_odd, high_odd, 0x88);
      row[i + 12] = _mm512_shuffle_f32x4(low_odd, high_odd, 0xDD);
    }
  }
  /// 16 bytes as integers.
  static Int load_bytes(const std::uint8_t* p) noexcept { return _mm512_cvtepu8_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p))); }
};
#endif

}  // namespace raymeter
