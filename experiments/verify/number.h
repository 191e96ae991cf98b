#pragma once

// Numbers for exact decisions. A predicate is written once, as a template over the number: first it runs on Approx, a double that knows how wrong it may be;
// where that leaves a sign open it throws Undecided, and the predicate runs again on GMP rationals. Every finite float is an exact rational.

#include <array>
#include <cmath>

#include <gmpxx.h>

namespace raymeter::verify {

struct Undecided {};

/// A double and a bound of its absolute error. The rounding of each operation is measured (TwoSum, FMA), so that exact operations keep the error 0.
struct Approx {
  double value = 0;
  double error = 0;

  Approx() = default;
  Approx(double exact) : value(exact) {}
  Approx(double v, double e) : value(v), error(e) {}
  friend Approx operator+(const Approx& a, const Approx& b) {
    const double sum = a.value + b.value;
    const double part = sum - a.value;
    const double lost = (a.value - (sum - part)) + (b.value - part);
    return {sum, (std::abs(lost) + a.error + b.error) * kGrowth};
  }
  friend Approx operator-(const Approx& a) { return {-a.value, a.error}; }
  friend Approx operator-(const Approx& a, const Approx& b) { return a + -b; }
  friend Approx operator*(const Approx& a, const Approx& b) {
    const double product = a.value * b.value;
    double lost = std::abs(std::fma(a.value, b.value, -product));
    // Near the underflow threshold the residual itself is rounded.
    if (std::abs(product) < 0x1p-900 && a.value != 0 && b.value != 0) lost += 0x1p-1000;
    return {product, (lost + std::abs(a.value) * b.error + std::abs(b.value) * a.error + a.error * b.error) * kGrowth};
  }
  friend Approx operator/(const Approx& a, const Approx& b) {
    if (!(std::abs(b.value) > 2 * b.error)) throw Undecided{};
    const double ratio = a.value / b.value;
    return {ratio, (std::abs(ratio) * 0x1p-53 + (a.error + std::abs(ratio) * b.error) / (std::abs(b.value) - b.error)) * kGrowth + 0x1p-1000};
  }

private:
  /// Covers the roundings of the error bound's own arithmetic.
  static constexpr double kGrowth = 1 + 0x1p-48;
};

[[nodiscard]] inline int sign(const Approx& a) {
  if (a.value > a.error) return 1;
  if (a.value < -a.error) return -1;
  if (a.value == 0 && a.error == 0) return 0;
  throw Undecided{};  // NaN and infinity end here too
}
[[nodiscard]] inline int sign(const mpq_class& a) { return sgn(a); }

/// The nearest double, good to 2^-40: values of t are compared with floats only.
[[nodiscard]] inline double to_double(const Approx& a) {
  if (!(a.error <= std::abs(a.value) * 0x1p-40) || !std::isfinite(a.value)) throw Undecided{};
  return a.value;
}
[[nodiscard]] inline double to_double(const mpq_class& a) { return a.get_d(); }

/// The larger of two; where Approx cannot tell, they are the same within its error.
[[nodiscard]] inline Approx larger(const Approx& a, const Approx& b) { return {std::fmax(a.value, b.value), std::fmax(a.error, b.error)}; }
[[nodiscard]] inline mpq_class larger(const mpq_class& a, const mpq_class& b) { return a < b ? b : a; }
template <class N>
[[nodiscard]] N smaller(const N& a, const N& b) {
  return -larger(N(-a), N(-b));
}

template <class N>
using Vec = std::array<N, 3>;

template <class N>
[[nodiscard]] Vec<N> vec(const float (&p)[3]) {
  return {N(double{p[0]}), N(double{p[1]}), N(double{p[2]})};
}
template <class N>
[[nodiscard]] Vec<N> operator-(const Vec<N>& a, const Vec<N>& b) {
  return {N(a[0] - b[0]), N(a[1] - b[1]), N(a[2] - b[2])};
}
template <class N>
[[nodiscard]] N dot(const Vec<N>& a, const Vec<N>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class N>
[[nodiscard]] Vec<N> cross(const Vec<N>& a, const Vec<N>& b) {
  return {N(a[1] * b[2] - a[2] * b[1]), N(a[2] * b[0] - a[0] * b[2]), N(a[0] * b[1] - a[1] * b[0])};
}

/// Sign of p + q sqrt(d), d >= 0.
template <class N>
[[nodiscard]] int sign_with_root(const N& p, const N& q, const N& d) {
  const int sign_p = sign(p);
  const int sign_q = sign(q) * sign(d);
  if (sign_p == 0 || sign_q == 0 || sign_p == sign_q) return sign_p != 0 ? sign_p : sign_q;
  return sign_p * sign(N(p * p - q * q * d));
}

/// Whether a predicate may begin with Approx, or is to be decided by rationals alone, slowly: the reference of the filter.
enum class Arithmetic { filtered, rational };

/// Calls predicate.operator()<N>() with the cheapest N that decides it.
template <class Predicate>
[[nodiscard]] auto decide(Arithmetic arithmetic, Predicate&& predicate) {
  if (arithmetic == Arithmetic::filtered) {
    try {
      return predicate.template operator()<Approx>();
    } catch (const Undecided&) {
    }
  }
  return predicate.template operator()<mpq_class>();
}

}  // namespace raymeter::verify
