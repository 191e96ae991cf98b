#pragma once

#include <array>
#include <cmath>

#include "core/ray/ray_batch.h"
#include "experiments/verify/number.h"

namespace raymeter::verify {

using Point = std::array<double, 3>;

[[nodiscard]] inline double dot(const Point& a, const Point& b) noexcept { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
[[nodiscard]] inline Point minus(const Point& a, const Point& b) noexcept { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
[[nodiscard]] inline Point along(const Point& a, double s, const Point& b) noexcept { return {a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]}; }
[[nodiscard]] inline double length(const Point& a) noexcept { return std::sqrt(dot(a, a)); }
[[nodiscard]] inline Point point(const float (&p)[3]) noexcept { return {double{p[0]}, double{p[1]}, double{p[2]}}; }

/// Points where a ray really meets a primitive inside its closed interval, in order of t (a double near the exact one).
struct TrueHits {
  std::array<double, 2> t{};
  int count = 0;

  void add(double at) noexcept { t[static_cast<std::size_t>(count++)] = at; }
};

/// A ray in numbers that decide. An infinite end of the interval bounds nothing.
template <class N>
struct NumberRay {
  Vec<N> org;
  Vec<N> dir;
  bool has_min, has_max;
  N t_min, t_max;

  explicit NumberRay(const Ray& ray)
      : org(vec<N>(ray.org)),
        dir(vec<N>(ray.dir)),
        has_min(std::isfinite(ray.t_min)),
        has_max(std::isfinite(ray.t_max)),
        t_min(has_min ? double{ray.t_min} : 0.0),
        t_max(has_max ? double{ray.t_max} : 0.0) {
    // An end at the wrong infinity leaves nothing: t is finite.
    if (ray.t_min > 0 && !has_min) t_min = 1, t_max = 0, has_min = has_max = true;
    if (ray.t_max < 0 && !has_max) t_min = 1, t_max = 0, has_min = has_max = true;
  }
  /// Whether t_min <= numerator / denominator <= t_max.
  [[nodiscard]] bool contains(const N& numerator, const N& denominator) const {
    const int s = sign(denominator);
    return (!has_min || s * sign(N(numerator - t_min * denominator)) >= 0) && (!has_max || s * sign(N(t_max * denominator - numerator)) >= 0);
  }
};

/// a t^2 + 2 b t + c with a != 0. `discriminant` is b^2 - a c, which the caller can often make with less cancellation.
template <class N>
struct Quadratic {
  N a, b, c, discriminant;

  /// Sign of p + q t at the root (-b + side sqrt(discriminant)) / a, side = -1 or 1.
  [[nodiscard]] int sign_at(int side, const N& p, const N& q) const { return sign(a) * sign_with_root(N(p * a - q * b), N(side * q), discriminant); }
  [[nodiscard]] double root(int side) const {
    if (sign(discriminant) == 0) return -to_double(b) / to_double(a);
    const double spread = std::sqrt(to_double(discriminant));
    if (sign(b) == 0) return side * spread / to_double(a);
    const double q = -(to_double(b) + sign(b) * spread);
    // The root whose terms have one sign is a plain sum, the other follows from the product of the roots.
    return side == -sign(b) ? q / to_double(a) : sign(c) == 0 ? 0.0 : to_double(c) / q;
  }
};

}  // namespace raymeter::verify
