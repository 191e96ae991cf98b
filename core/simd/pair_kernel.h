#pragma once

// Sums and products without their rounding error, as unevaluated pairs of floats (Knuth 1969; Dekker 1971): about 48 bits, with or without FMA. Exact as long
// as nothing overflows and no tail is denormal; no fast-math and no contraction (CMakeLists.txt).

#include "core/simd/lanes.h"

namespace raymeter {

/// value + tail. Errors below are in u^2, u = 2^-24, and hold where |tail| <= 4 u |value|, as all that is returned here does.
template <class L>
struct FloatPair {
  typename L::Float value;
  typename L::Float tail;
};

/// a + b, exactly.
template <class L>
[[gnu::always_inline]] inline FloatPair<L> exact_sum(typename L::Float a, typename L::Float b) noexcept {
  const typename L::Float sum = a + b, b_part = sum - a;
  return {sum, (a - (sum - b_part)) + (b - b_part)};
}

/// a * b, exactly.
template <class L>
[[gnu::always_inline]] inline FloatPair<L> exact_product(typename L::Float a, typename L::Float b) noexcept {
  const typename L::Float product = a * b;
  return {product, L::difference_of_products(a, b, product, typename L::Float(1.0f))};
}

/// p + q, summed anew so that the tail is small even where values cancel; error 18 u^2 (|p| + |q|), 5 where tails are u of their values at most.
template <class L>
[[gnu::always_inline]] inline FloatPair<L> sum(const FloatPair<L>& p, const FloatPair<L>& q) noexcept {
  const FloatPair<L> values = exact_sum<L>(p.value, q.value);
  return exact_sum<L>(values.value, values.tail + (p.tail + q.tail));
}

/// p - q, as sum().
template <class L>
[[gnu::always_inline]] inline FloatPair<L> difference(const FloatPair<L>& p, const FloatPair<L>& q) noexcept {
  return sum(p, FloatPair<L>{-q.value, -q.tail});
}

/// p * b; error 9 u^2 |p b|, 3 where p's tail is u of its value at most.
template <class L>
[[gnu::always_inline]] inline FloatPair<L> product(const FloatPair<L>& p, typename L::Float b) noexcept {
  const FloatPair<L> values = exact_product<L>(p.value, b);
  return {values.value, L::mul_add(p.tail, b, values.tail)};
}

/// p * q; error 38 u^2 |p q|, 8 where tails are u of their values at most.
template <class L>
[[gnu::always_inline]] inline FloatPair<L> product(const FloatPair<L>& p, const FloatPair<L>& q) noexcept {
  const FloatPair<L> values = exact_product<L>(p.value, q.value);
  return {values.value, L::mul_add(p.value, q.tail, L::mul_add(p.tail, q.value, values.tail))};
}

}  // namespace raymeter
