#pragma once

// Ray against sphere, without cancellation near, far and huge: Haines, Guenther, Akenine-Moeller 2019 (Ray Tracing Gems, ch. 7). The discriminant comes from
// the vector that is perpendicular to the ray at its closest approach; the nearer root, where it would be a difference of nearly equal numbers, is c / q, c in
// the factored form (|f| - r)(|f| + r), good for huge radii.
//
// Hit or miss is decided as exact arithmetic would, but for rays that pass within kSilhouetteError (|f| + r) of the silhouette: lanes whose discriminant is too
// close to 0 for its sign to be certain get it anew in pairs of floats, as r^2 - |f x d|^2 / d^2 of the floats that are given. With u = 2^-24 a moment f x d is
// then off by 12 u^2 |f| |d| and the discriminant by 30 u^2 (r^2 + |f x d|^2 / d^2) besides.
// Proof that the others are certain: let F = |f|, p the exact perpendicular, q the computed one (a vector of floats, of exact length). Across the ray q is off
// by u F from rounding f, by u F from rounding products and by u q from sums; along the ray by 9 u F + u q in all. Hence
// |q^2 - p^2| <= (2 u F + u q)(p + q) + (9 u F + u q)^2, and with the roundings of q^2, r^2 and their difference the discriminant is off by at most
// 4 u F q + 85 u^2 F^2 + 6 u q^2 + 2 u r^2 and terms of u^2 F q. Let G = |f . d| / |d|, so that F <= G + p. If p <= r, then q <= r + 11 u G + O(u r), and the
// sum is below 8 u (G + 6 r)(r + 16 u G); if p > r but the computed discriminant is positive, q < r and likewise. Since 2 r G <= 2^11 r^2 + 2^-11 G^2, that is
// less than kUnsureOfRadius r^2 + kUnsureOfWay G^2: a two-thousandth of the radius, for eyes up to two thousand radii away.
//
// Error of t: an error along the ray of the closest approach (10 roundings of |f| at most) changes the perpendicular only in second order. What remains across
// the ray is the rounding of f, of the perpendicular and of r^2: 3 roundings of |f| + r. Along the ray, t adds 10 for the far root, and the product of the
// roots 4 (|f| + r) more for the near one; at grazing incidence the latter is large along the ray but not away from the sphere. Together less than
// kSurfaceError. t is clamped to the ray's interval in the sphere's box.

#include "core/bounds/slab_kernel.h"
#include "core/ray/ray_packet.h"
#include "core/scene/pools_view.h"
#include "core/simd/pair_kernel.h"

namespace raymeter {

/// How much the discriminant may be off, relative to r^2 and to (f . d)^2 / d^2.
inline constexpr float kUnsureOfRadius = 0x1.1p-11f;
inline constexpr float kUnsureOfWay = 0x1.1p-33f;

/// r^2 less the squared distance of the line from the centre, from floats as they are given; see kSilhouetteError.
template <class L>
[[gnu::always_inline]] inline typename L::Float chord2_in_pairs(const RayPacket<L>& ray, const typename L::Float (&center)[3],
                                                                typename L::Float radius) noexcept {
  using Float = typename L::Float;
  using Pair = FloatPair<L>;
  const Float quarter(0.25f);  // of a direction in [1, 2): nothing below exceeds |f|^2
  const Float dir[3] = {quarter * ray.dir[0], quarter * ray.dir[1], quarter * ray.dir[2]};
  const Pair from[3] = {exact_sum<L>(ray.org[0], -center[0]), exact_sum<L>(ray.org[1], -center[1]), exact_sum<L>(ray.org[2], -center[2])};
  Pair length2 = exact_product<L>(dir[0], dir[0]);
  for (int a = 1; a < 3; ++a) length2 = sum(length2, exact_product<L>(dir[a], dir[a]));
  Pair chord2 = product(exact_product<L>(radius, radius), length2);
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    const Pair moment = difference(product(from[b], dir[c]), product(from[c], dir[b]));
    chord2 = difference(chord2, product(moment, moment));
  }
  return chord2.value / length2.value;
}

/// `kExpectHits` saves the branch that ends a test which no lane passes.
template <class L, bool kExpectHits = false>
[[gnu::always_inline]] inline SurfaceHit<L> intersect_sphere(const RayPacket<L>& ray, const typename L::Float (&center)[3], typename L::Float radius) noexcept {
  using Float = typename L::Float;
  const Float zero(0.0f);
  const Float from[3] = {ray.org[0] - center[0], ray.org[1] - center[1], ray.org[2] - center[2]};
  const Float f_dir = L::mul_add(from[2], ray.dir[2], L::mul_add(from[1], ray.dir[1], from[0] * ray.dir[0]));
  const Float closest = -f_dir * ray.inv_length2;
  const Float across[3] = {L::mul_add(closest, ray.dir[0], from[0]), L::mul_add(closest, ray.dir[1], from[1]), L::mul_add(closest, ray.dir[2], from[2])};
  const Float across2 = L::mul_add(across[2], across[2], L::mul_add(across[1], across[1], across[0] * across[0]));
  const Float radius2 = radius * radius;
  // Squared radius and what the difference may be off by.
  const Float farthest2 = L::neg_mul_add(f_dir * Float(kUnsureOfWay), closest, radius2 * Float(1 + kUnsureOfRadius));
  SurfaceHit<L> hit{across2 <= farthest2, zero, zero, zero};
  if (!kExpectHits && L::none(hit.meets)) return hit;
  Float chord2 = radius2 - across2;
  if (const auto unsure = hit.meets & (chord2 <= farthest2 - radius2); L::any(unsure)) [[unlikely]] {
    chord2 = L::select(unsure, chord2_in_pairs<L>(ray, center, radius), chord2);
    hit.meets = hit.meets & (chord2 >= zero);
  }

  const Float half_chord = L::sqrt(L::max(chord2, zero) * ray.inv_length2);
  // The root of larger magnitude is a plain sum; the other is a difference, or follows from the product of the roots, c / dir^2.
  const Float away = L::select(closest < zero, -half_chord, half_chord);
  const Float far_root = closest + away;
  const Float distance = L::sqrt(L::mul_add(from[2], from[2], L::mul_add(from[1], from[1], from[0] * from[0])));
  const Float product = (distance - radius) * (distance + radius) * ray.inv_length2;
  const Float from_product = L::select(far_root == zero, zero, product / far_root);
  const Float near_root = L::select(L::abs(closest) > half_chord + half_chord, closest - away, from_product);
  const Float t_enter = L::min(near_root, far_root);
  const Float t_exit = L::max(near_root, far_root);
  const Float box_radius = radius * Float(1 + 2 * kOwnBoxPadding);
  const Float low[3] = {-from[0] - box_radius, -from[1] - box_radius, -from[2] - box_radius};
  const Float high[3] = {box_radius - from[0], box_radius - from[1], box_radius - from[2]};
  const SlabInterval<L> in_box = line_in_own_box<L>(ray, low, high);
  hit.meets = hit.meets & (in_box.t_near <= in_box.t_far);
  hit.t = L::min(L::max(L::select(t_enter >= ray.t_min, t_enter, t_exit), in_box.t_near), in_box.t_far);
  return hit;
}

template <class L>
[[gnu::always_inline]] inline SurfaceHit<L> intersect_sphere(const RayPacket<L>& ray, const SphereView& pool, std::int32_t i) noexcept {
  using Float = typename L::Float;
  const Float center[3] = {Float(pool.center[0][i]), Float(pool.center[1][i]), Float(pool.center[2][i])};
  return intersect_sphere<L>(ray, center, Float(pool.radius[i]));
}

}  // namespace raymeter
