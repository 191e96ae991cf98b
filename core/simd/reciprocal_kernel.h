#pragma once

#include "core/simd/lanes.h"

namespace raymeter {

/// The processor's own 1 / a, off by 1.5 * 2^-12 of it at most (AVX-512: 2^-14); +-0 gives +-infinity, and so may what is denormal. Processors differ in its
/// bits.
template <class L>
[[gnu::always_inline]] inline typename L::Float reciprocal_estimate(typename L::Float a) noexcept {
  if constexpr (L::kIsa == Isa::scalar) return _mm_cvtss_f32(_mm_rcp_ss(_mm_set_ss(a.value)));
#ifdef __SSE4_2__
  if constexpr (L::kIsa == Isa::sse42) return _mm_rcp_ps(a);
#endif
#if defined(__AVX2__) && defined(__FMA__)
  if constexpr (L::kIsa == Isa::avx2) return _mm256_rcp_ps(a);
#endif
#ifdef __AVX512DQ__
  if constexpr (L::kIsa == Isa::avx512) return _mm512_rcp14_ps(a);
#endif
}

}  // namespace raymeter
