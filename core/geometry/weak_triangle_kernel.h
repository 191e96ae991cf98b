#pragma once

// Triangle tests without the guards of triangle_kernel.h, as published. All are two-sided and closed.
//   woop              Woop, Benthin, Wald 2013 with plain differences of rounded products. Rounding is monotone, so that the sign of such a difference is right
//                     or 0: no edge leaks. What is lost is the size of the weights of slivers, and with it t.
//   moeller_trumbore  Moeller, Trumbore 1997 (JGT 2(1)), without a culling epsilon; in float, or lane by lane in double.
//   pluecker          Pluecker edge tests relative to the origin (Davidovic et al. 2012; with an epsilon of 2^-23 Embree's robust test).
// The latter two may take an epsilon: weights are inside down to minus so much of their sum. It closes edges from outside, and lets rays beside them hit.
//   baldwin_weber     Baldwin, Weber 2016 (JCGT 5(3)): the ray in the space of the unit triangle, by maps made at build time.

#include "core/geometry/triangle_kernel.h"
#include "core/geometry/unit_triangle_layout.h"

namespace raymeter {

template <class L>
struct Vector {
  typename L::Float x, y, z;
};

template <class L>
[[gnu::always_inline]] inline Vector<L> minus(const Vector<L>& a, const Vector<L>& b) noexcept {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class L>
[[gnu::always_inline]] inline Vector<L> cross(const Vector<L>& a, const Vector<L>& b) noexcept {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class L>
[[gnu::always_inline]] inline typename L::Float dot(const Vector<L>& a, const Vector<L>& b) noexcept {
  return L::mul_add(a.z, b.z, L::mul_add(a.y, b.y, a.x * b.x));
}
template <class L>
[[gnu::always_inline]] inline Vector<L> triple(const typename L::Float (&v)[3]) noexcept {
  return {v[0], v[1], v[2]};
}
template <class L>
[[gnu::always_inline]] inline Vector<L> vertex_of(const TriangleView& pool, int k, std::int32_t i) noexcept {
  using Float = typename L::Float;
  return {Float(pool.vertex[k][0][i]), Float(pool.vertex[k][1][i]), Float(pool.vertex[k][2][i])};
}

/// Whether all have one sign, those within `room` of 0 either.
template <class L>
[[gnu::always_inline]] inline typename L::Mask one_sign(typename L::Float a, typename L::Float b, typename L::Float c, typename L::Float room) noexcept {
  return (L::min(L::min(a, b), c) >= -room) | (L::max(L::max(a, b), c) <= room);
}

template <class L>
[[gnu::always_inline]] inline SurfaceHit<L> woop_triangle(const RayPacket<L>& ray, const TriangleView& pool, std::int32_t triangle) noexcept {
  using Float = typename L::Float;
  const Float zero(0.0f);
  const std::int32_t i = triangle * pool.stride;
  const auto a = shear(ray, pool.vertex[0], i), b = shear(ray, pool.vertex[1], i), c = shear(ray, pool.vertex[2], i);
  const Float weight_a = c.x * b.y - c.y * b.x;
  const Float weight_b = a.x * c.y - a.y * c.x;
  const Float weight_c = b.x * a.y - b.y * a.x;
  const Float det = weight_a + weight_b + weight_c;
  SurfaceHit<L> hit{one_sign<L>(weight_a, weight_b, weight_c, zero) & (det != zero), zero, zero, zero};
  if (L::none(hit.meets)) return hit;
  const Float inv_det = Float(1.0f) / det;
  hit.u = weight_b * inv_det;
  hit.v = weight_c * inv_det;
  hit.t = L::mul_add(weight_c, c.z, L::mul_add(weight_b, b.z, weight_a * a.z)) * inv_det;
  return hit;
}

template <bool kEpsilon, class L>
[[gnu::always_inline]] inline SurfaceHit<L> moeller_trumbore_triangle(const RayPacket<L>& ray, const TriangleView& pool, std::int32_t triangle,
                                                                      float epsilon) noexcept {
  using Float = typename L::Float;
  const Float zero(0.0f), one(1.0f);
  const std::int32_t i = triangle * pool.stride;
  const Vector<L> a = vertex_of<L>(pool, 0, i), dir = triple<L>(ray.dir);
  const Vector<L> to_b = minus<L>(vertex_of<L>(pool, 1, i), a), to_c = minus<L>(vertex_of<L>(pool, 2, i), a);
  const Vector<L> p = cross<L>(dir, to_c);
  const Float det = dot<L>(to_b, p);
  const Float inv_det = one / det;
  const Vector<L> from_a = minus<L>(triple<L>(ray.org), a);
  const Vector<L> q = cross<L>(from_a, to_b);
  SurfaceHit<L> hit{det != zero, zero, dot<L>(from_a, p) * inv_det, dot<L>(dir, q) * inv_det};
  const Float least = kEpsilon ? Float(-epsilon) : zero, most = kEpsilon ? Float(1 + epsilon) : one;
  hit.meets = hit.meets & (hit.u >= least) & (hit.v >= least) & (hit.u + hit.v <= most);
  hit.t = dot<L>(to_c, q) * inv_det;
  return hit;
}

/// The same in double, each lane alone: the packet's registers hold floats.
template <class L>
inline SurfaceHit<L> moeller_trumbore_double_triangle(const RayPacket<L>& ray, const TriangleView& pool, std::int32_t triangle) noexcept {
  constexpr int kWidth = L::kWidth;
  alignas(64) float org[3][kWidth], dir[3][kWidth], t[kWidth], u[kWidth], v[kWidth];
  const std::int32_t i = triangle * pool.stride;
  double a[3], to_b[3], to_c[3];
  for (int d = 0; d < 3; ++d) {
    L::store(org[d], ray.org[d]);
    L::store(dir[d], ray.dir[d]);
    a[d] = pool.vertex[0][d][i];
    to_b[d] = pool.vertex[1][d][i] - a[d];
    to_c[d] = pool.vertex[2][d][i] - a[d];
  }
  for (int lane = 0; lane < kWidth; ++lane) {
    const double d[3] = {dir[0][lane], dir[1][lane], dir[2][lane]};
    const double f[3] = {org[0][lane] - a[0], org[1][lane] - a[1], org[2][lane] - a[2]};
    const double p[3] = {d[1] * to_c[2] - d[2] * to_c[1], d[2] * to_c[0] - d[0] * to_c[2], d[0] * to_c[1] - d[1] * to_c[0]};
    const double q[3] = {f[1] * to_b[2] - f[2] * to_b[1], f[2] * to_b[0] - f[0] * to_b[2], f[0] * to_b[1] - f[1] * to_b[0]};
    const double inv_det = 1 / (to_b[0] * p[0] + to_b[1] * p[1] + to_b[2] * p[2]);
    const double weight_b = (f[0] * p[0] + f[1] * p[1] + f[2] * p[2]) * inv_det;
    const double weight_c = (d[0] * q[0] + d[1] * q[1] + d[2] * q[2]) * inv_det;
    const bool meets = weight_b >= 0 && weight_c >= 0 && weight_b + weight_c <= 1;
    t[lane] = meets ? static_cast<float>((to_c[0] * q[0] + to_c[1] * q[1] + to_c[2] * q[2]) * inv_det) : __builtin_nanf("");
    u[lane] = static_cast<float>(weight_b);
    v[lane] = static_cast<float>(weight_c);
  }
  const typename L::Float found = L::load(t);
  return {found == found, found, L::load(u), L::load(v)};
}

template <bool kEpsilon, class L>
[[gnu::always_inline]] inline SurfaceHit<L> pluecker_triangle(const RayPacket<L>& ray, const TriangleView& pool, std::int32_t triangle,
                                                              float epsilon) noexcept {
  using Float = typename L::Float;
  const Float zero(0.0f);
  const std::int32_t i = triangle * pool.stride;
  const Vector<L> org = triple<L>(ray.org), dir = triple<L>(ray.dir);
  const Vector<L> a = minus<L>(vertex_of<L>(pool, 0, i), org), b = minus<L>(vertex_of<L>(pool, 1, i), org), c = minus<L>(vertex_of<L>(pool, 2, i), org);
  const auto weight = [&](const Vector<L>& from, const Vector<L>& to) noexcept {
    return dot<L>(cross<L>(minus<L>(to, from), Vector<L>{to.x + from.x, to.y + from.y, to.z + from.z}), dir);
  };
  const Float weight_a = weight(b, c), weight_b = weight(c, a), weight_c = weight(a, b);
  const Float room = kEpsilon ? Float(epsilon) * L::abs(weight_a + weight_b + weight_c) : zero;
  SurfaceHit<L> hit{one_sign<L>(weight_a, weight_b, weight_c, room), zero, zero, zero};
  if (L::none(hit.meets)) return hit;
  const Vector<L> normal = cross<L>(minus<L>(b, a), minus<L>(c, a));
  const Float slope = dot<L>(normal, dir);
  const Float inv_sum = Float(1.0f) / (weight_a + weight_b + weight_c);
  hit.meets = hit.meets & (slope != zero);
  hit.t = dot<L>(normal, a) / slope;
  hit.u = weight_b * inv_sum;
  hit.v = weight_c * inv_sum;
  return hit;
}

template <class L>
[[gnu::always_inline]] inline SurfaceHit<L> baldwin_weber_triangle(const RayPacket<L>& ray, const UnitTriangleView& triangles, std::int32_t i) noexcept {
  using Float = typename L::Float;
  const Float zero(0.0f);
  constexpr int next[5] = {0, 1, 2, 0, 1};
  const float* map = triangles.map + 9 * std::int64_t{i};
  const int r = triangles.axis[i], p = next[r + 1], q = next[r + 2];
  const auto mapped = [map](int row, Float x, Float y, Float added) noexcept {
    return L::mul_add(Float(map[row]), x, L::mul_add(Float(map[row + 1]), y, added));
  };
  const Float climb = mapped(6, ray.dir[p], ray.dir[q], ray.dir[r]);
  const Float height = mapped(6, ray.org[p], ray.org[q], ray.org[r] + Float(map[8]));
  const Float t = -height / climb;
  const Float x = L::mul_add(t, ray.dir[p], ray.org[p]), y = L::mul_add(t, ray.dir[q], ray.org[q]);
  SurfaceHit<L> hit{climb != zero, t, mapped(0, x, y, Float(map[2])), mapped(3, x, y, Float(map[5]))};
  hit.meets = hit.meets & (hit.u >= zero) & (hit.v >= zero) & (hit.u + hit.v <= Float(1.0f));
  return hit;
}

}  // namespace raymeter
