#pragma once

// The one place that knows register types. A kernel is written against Lanes<I>: Float, Int, Mask and the operations below; `+ - * / < <= > >= == & | ~`
// are those of the types themselves. Each specialisation exists only where its flags are on, so that no other file can instantiate it.
//
// power_of_two(a) is the largest power of two not above |a|, 0 for denormal numbers.
// max(a, b) and min(a, b) return b when either is NaN, as the x86 instructions do: slab tests drop NaN by passing the accumulator second.

#include <cstdint>
#include <type_traits>

#include <xsimd/xsimd.hpp>

#include "core/simd/isa_enum.h"

#ifdef __AVX512DQ__
namespace xsimd {
// As xsimd 8.1.0 writes them, compilers take masks out of their registers and back.
template <>
[[gnu::always_inline]] inline batch_bool<float, avx512dq> batch_bool<float, avx512dq>::operator&(const batch_bool& other) const noexcept {
  return register_type(_kand_mask16(data, other.data));
}
template <>
[[gnu::always_inline]] inline batch_bool<float, avx512dq> batch_bool<float, avx512dq>::operator|(const batch_bool& other) const noexcept {
  return register_type(_kor_mask16(data, other.data));
}
}  // namespace xsimd
#endif

namespace raymeter {

#ifdef RAYMETER_KERNEL_ISA
/// The instruction set this file is being compiled for.
inline constexpr Isa kKernelIsa = Isa::RAYMETER_KERNEL_ISA;
#endif

template <Isa I>
struct Lanes;

/// Batches of width one, with the same operators as xsimd's.
template <Isa I>
struct ScalarMask {
  bool value;
  friend ScalarMask operator&(ScalarMask a, ScalarMask b) noexcept { return {a.value && b.value}; }
  friend ScalarMask operator|(ScalarMask a, ScalarMask b) noexcept { return {a.value || b.value}; }
  friend ScalarMask operator~(ScalarMask a) noexcept { return {!a.value}; }
};

template <Isa I, class T>
struct Scalar {
  T value;
  Scalar() = default;
  Scalar(T v) noexcept : value(v) {}  // as xsimd: a number is a batch
  friend Scalar operator+(Scalar a, Scalar b) noexcept { return a.value + b.value; }
  friend Scalar operator-(Scalar a, Scalar b) noexcept { return a.value - b.value; }
  friend Scalar operator*(Scalar a, Scalar b) noexcept { return a.value * b.value; }
  friend Scalar operator/(Scalar a, Scalar b) noexcept { return a.value / b.value; }
  friend Scalar operator-(Scalar a) noexcept { return -a.value; }
  friend Scalar operator&(Scalar a, Scalar b) noexcept requires std::is_integral_v<T> { return a.value & b.value; }
  friend ScalarMask<I> operator<(Scalar a, Scalar b) noexcept { return {a.value < b.value}; }
  friend ScalarMask<I> operator<=(Scalar a, Scalar b) noexcept { return {a.value <= b.value}; }
  friend ScalarMask<I> operator>(Scalar a, Scalar b) noexcept { return {a.value > b.value}; }
  friend ScalarMask<I> operator>=(Scalar a, Scalar b) noexcept { return {a.value >= b.value}; }
  friend ScalarMask<I> operator==(Scalar a, Scalar b) noexcept { return {a.value == b.value}; }
  friend ScalarMask<I> operator!=(Scalar a, Scalar b) noexcept { return {a.value != b.value}; }
};

template <>
struct Lanes<Isa::scalar> {
  static constexpr Isa kIsa = Isa::scalar;
  static constexpr int kWidth = 1;
  using Float = Scalar<Isa::scalar, float>;
  using Int = Scalar<Isa::scalar, std::int32_t>;
  using Mask = ScalarMask<Isa::scalar>;

  static Float load(const float* p) noexcept { return *p; }
  static Int load(const std::int32_t* p) noexcept { return *p; }
  static void store(float* p, Float v) noexcept { *p = v.value; }
  static void store(std::int32_t* p, Int v) noexcept { *p = v.value; }
  static Float gather(const float* p, Int i) noexcept { return p[i.value]; }
  static Int gather(const std::int32_t* p, Int i) noexcept { return p[i.value]; }
  static Int iota() noexcept { return 0; }

  static Float min(Float a, Float b) noexcept { return a.value < b.value ? a : b; }
  static Float max(Float a, Float b) noexcept { return a.value > b.value ? a : b; }
  static Float abs(Float a) noexcept { return __builtin_fabsf(a.value); }
  static Float sqrt(Float a) noexcept { return __builtin_sqrtf(a.value); }
  static Float power_of_two(Float a) noexcept { return __builtin_bit_cast(float, __builtin_bit_cast(std::uint32_t, a.value) & 0x7F800000u); }
  static Int truncate(Float a) noexcept { return static_cast<std::int32_t>(a.value); }
  static Float to_float(Int a) noexcept { return static_cast<float>(a.value); }
  static Float mul_add(Float a, Float b, Float c) noexcept { return a.value * b.value + c.value; }
  static Float neg_mul_add(Float a, Float b, Float c) noexcept { return c.value - a.value * b.value; }
  static Float difference_of_products(Float a, Float b, Float c, Float d) noexcept {
    return static_cast<float>(double{a.value} * double{b.value} - double{c.value} * double{d.value});
  }

  static Float select(Mask m, Float a, Float b) noexcept { return m.value ? a : b; }
  static Int select(Mask m, Int a, Int b) noexcept { return m.value ? a : b; }
  static Mask equal(Int a, Int b) noexcept { return {a.value == b.value}; }
  static Mask less(Int a, Int b) noexcept { return {a.value < b.value}; }
  static Mask negative(Float a) noexcept { return {__builtin_signbit(a.value) != 0}; }
  static bool any(Mask m) noexcept { return m.value; }
  static bool none(Mask m) noexcept { return !m.value; }
  static bool all(Mask m) noexcept { return m.value; }
  static std::uint32_t bits(Mask m) noexcept { return m.value ? 1u : 0u; }
  static Mask mask(std::uint32_t bits) noexcept { return {(bits & 1u) != 0}; }
  static float reduce_min(Float a) noexcept { return a.value; }
  static float reduce_max(Float a) noexcept { return a.value; }
};

/// What the three vector instruction sets share through xsimd.
template <Isa I, class Arch, int Width>
struct BatchLanes {
  static constexpr Isa kIsa = I;
  static constexpr int kWidth = Width;
  using Float = xsimd::batch<float, Arch>;
  using Int = xsimd::batch<std::int32_t, Arch>;
  using Mask = xsimd::batch_bool<float, Arch>;
  using IntMask = xsimd::batch_bool<std::int32_t, Arch>;
  static_assert(Float::size == Width);

  static Float load(const float* p) noexcept { return Float::load_unaligned(p); }
  static Int load(const std::int32_t* p) noexcept { return Int::load_unaligned(p); }
  static void store(float* p, Float v) noexcept { v.store_unaligned(p); }
  static void store(std::int32_t* p, Int v) noexcept { v.store_unaligned(p); }
  static Float gather(const float* p, Int i) noexcept { return Float::gather(p, i); }
  static Int gather(const std::int32_t* p, Int i) noexcept { return Int::gather(p, i); }
  static Int iota() noexcept {
    alignas(64) std::int32_t lanes[Width];
    for (int i = 0; i < Width; ++i) lanes[i] = i;
    return load(lanes);
  }

  static Float min(Float a, Float b) noexcept { return xsimd::min(a, b); }
  static Float max(Float a, Float b) noexcept { return xsimd::max(a, b); }
  static Float abs(Float a) noexcept { return xsimd::abs(a); }
  static Float sqrt(Float a) noexcept { return xsimd::sqrt(a); }
  static Float power_of_two(Float a) noexcept { return xsimd::bitwise_cast<Float>(xsimd::bitwise_cast<Int>(a) & Int(0x7F800000)); }
  static Int truncate(Float a) noexcept { return xsimd::to_int(a); }
  static Float to_float(Int a) noexcept { return xsimd::to_float(a); }

  static Float select(Mask m, Float a, Float b) noexcept { return xsimd::select(m, a, b); }
  static Int select(Mask m, Int a, Int b) noexcept { return xsimd::select(xsimd::bool_cast(m), a, b); }
  static Mask equal(Int a, Int b) noexcept { return xsimd::bool_cast(IntMask(a == b)); }
  static Mask less(Int a, Int b) noexcept { return xsimd::bool_cast(IntMask(a < b)); }
};

#ifdef __SSE4_2__
template <>
struct Lanes<Isa::sse42> : BatchLanes<Isa::sse42, xsimd::sse4_2, 4> {
  static Float mul_add(Float a, Float b, Float c) noexcept { return a * b + c; }
  static Float neg_mul_add(Float a, Float b, Float c) noexcept { return c - a * b; }
  // Products of floats are exact in double, so the sign of the difference is exact, as with FMA.
  static Float difference_of_products(Float a, Float b, Float c, Float d) noexcept {
    const auto half = [](__m128 p, __m128 q, __m128 r, __m128 s) noexcept {
      return _mm_cvtpd_ps(_mm_sub_pd(_mm_mul_pd(_mm_cvtps_pd(p), _mm_cvtps_pd(q)), _mm_mul_pd(_mm_cvtps_pd(r), _mm_cvtps_pd(s))));
    };
    const auto upper = [](__m128 v) noexcept { return _mm_movehl_ps(v, v); };
    return _mm_movelh_ps(half(a, b, c, d), half(upper(a), upper(b), upper(c), upper(d)));
  }
  static Mask negative(Float a) noexcept { return _mm_castsi128_ps(_mm_srai_epi32(_mm_castps_si128(a), 31)); }
  static std::uint32_t bits(Mask m) noexcept { return static_cast<std::uint32_t>(_mm_movemask_ps(m)); }
  static bool any(Mask m) noexcept { return bits(m) != 0; }
  static bool none(Mask m) noexcept { return bits(m) == 0; }
  static bool all(Mask m) noexcept { return bits(m) == 0xFu; }
  static Mask mask(std::uint32_t bits) noexcept {
    const __m128i lane = _mm_set_epi32(8, 4, 2, 1);
    return _mm_castsi128_ps(_mm_cmpeq_epi32(_mm_and_si128(_mm_set1_epi32(static_cast<int>(bits)), lane), lane));
  }
  static float reduce_min(Float a) noexcept {
    const __m128 pairs = _mm_min_ps(a, _mm_movehl_ps(a, a));
    return _mm_cvtss_f32(_mm_min_ss(pairs, _mm_shuffle_ps(pairs, pairs, 1)));
  }
  static float reduce_max(Float a) noexcept {
    const __m128 pairs = _mm_max_ps(a, _mm_movehl_ps(a, a));
    return _mm_cvtss_f32(_mm_max_ss(pairs, _mm_shuffle_ps(pairs, pairs, 1)));
  }
};
#endif

#if defined(__AVX2__) && defined(__FMA__)
template <>
struct Lanes<Isa::avx2> : BatchLanes<Isa::avx2, xsimd::avx2, 8> {
  static Float mul_add(Float a, Float b, Float c) noexcept { return _mm256_fmadd_ps(a, b, c); }
  static Float neg_mul_add(Float a, Float b, Float c) noexcept { return _mm256_fnmadd_ps(a, b, c); }
  // Kahan: the error of the second product is recovered by FMA, so that the sign is that of the exact difference.
  static Float difference_of_products(Float a, Float b, Float c, Float d) noexcept {
    const __m256 cd = _mm256_mul_ps(c, d);
    const __m256 error = _mm256_fnmadd_ps(c, d, cd);
    return _mm256_add_ps(_mm256_fmsub_ps(a, b, cd), error);
  }
  static Mask negative(Float a) noexcept { return _mm256_castsi256_ps(_mm256_srai_epi32(_mm256_castps_si256(a), 31)); }
  static std::uint32_t bits(Mask m) noexcept { return static_cast<std::uint32_t>(_mm256_movemask_ps(m)); }
  static bool any(Mask m) noexcept { return bits(m) != 0; }
  static bool none(Mask m) noexcept { return bits(m) == 0; }
  static bool all(Mask m) noexcept { return bits(m) == 0xFFu; }
  static Mask mask(std::uint32_t bits) noexcept {
    const __m256i lane = _mm256_set_epi32(128, 64, 32, 16, 8, 4, 2, 1);
    return _mm256_castsi256_ps(_mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(static_cast<int>(bits)), lane), lane));
  }
  static float reduce_min(Float a) noexcept {
    const __m128 half = _mm_min_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps(a, 1));
    const __m128 pairs = _mm_min_ps(half, _mm_movehl_ps(half, half));
    return _mm_cvtss_f32(_mm_min_ss(pairs, _mm_shuffle_ps(pairs, pairs, 1)));
  }
  static float reduce_max(Float a) noexcept {
    const __m128 half = _mm_max_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps(a, 1));
    const __m128 pairs = _mm_max_ps(half, _mm_movehl_ps(half, half));
    return _mm_cvtss_f32(_mm_max_ss(pairs, _mm_shuffle_ps(pairs, pairs, 1)));
  }
};
#endif

#ifdef __AVX512DQ__
// xsimd 8.1.0 has no AVX-512 FMA, and its select on int32 does not compile at -O0 with avx512bw: hence avx512dq and intrinsics here.
template <>
struct Lanes<Isa::avx512> : BatchLanes<Isa::avx512, xsimd::avx512dq, 16> {
  static Float mul_add(Float a, Float b, Float c) noexcept { return _mm512_fmadd_ps(a, b, c); }
  static Float neg_mul_add(Float a, Float b, Float c) noexcept { return _mm512_fnmadd_ps(a, b, c); }
  static Float difference_of_products(Float a, Float b, Float c, Float d) noexcept {
    const __m512 cd = _mm512_mul_ps(c, d);
    const __m512 error = _mm512_fnmadd_ps(c, d, cd);
    return _mm512_add_ps(_mm512_fmsub_ps(a, b, cd), error);
  }
  static Mask negative(Float a) noexcept { return _mm512_movepi32_mask(_mm512_castps_si512(a)); }
  static std::uint32_t bits(Mask m) noexcept {
    __mmask16 lanes = m;
    // g++ 12 takes a compare that widens its mask for one, keeps it in two bytes of the stack and reads four: the statement parts the two.
    asm("" : "+kr"(lanes));
    return lanes;
  }
  static bool any(Mask m) noexcept { return static_cast<__mmask16>(m) != 0; }
  static bool none(Mask m) noexcept { return static_cast<__mmask16>(m) == 0; }
  static bool all(Mask m) noexcept { return static_cast<__mmask16>(m) == 0xFFFFu; }
  static Mask mask(std::uint32_t bits) noexcept { return static_cast<__mmask16>(bits); }
  static float reduce_min(Float a) noexcept { return _mm512_reduce_min_ps(a); }
  static float reduce_max(Float a) noexcept { return _mm512_reduce_max_ps(a); }
};
#endif

}  // namespace raymeter
