#pragma once

// Ray against sphere, without cancellation near, far and huge: Haines, Guenther, Akenine-Moeller 2019 (Ray Tracing Gems, ch. 7). The discriminant comes from
// the vector that is perpendicular to the ray at its closest approach; the nearer root, where it would be a difference of nearly equal numbers, is c / q, c in
// the factored form (|f| - r)(|f| + r), good for huge radii.
//
// Error: an error along the ray of the closest approach (10 roundings of |f| at most) changes the perpendicular only in second order. What remains across the
// ray is the rounding of f, of the perpendicular and of r^2: 3 roundings of |f| + r. Along the ray, t adds 10 for the far root, and the product of the roots
// 4 (|f| + r) more for the near one; at grazing incidence the latter is large along the ray but not away from the sphere. Together less than kSurfaceError.
// A far small sphere seen at its silhouette could be met beside its box by the second-order term: t is clamped to the ray's interval in the box, and a ray that
// passes beside it misses. Boundary band: rays that pass within kSurfaceError of the silhouette.

#include "core/bounds/slab_kernel.h"
#include "core/ray/ray_packet.h"
#include "core/scene/pools_view.h"

namespace raymeter {

/// `from` is the ray's origin minus the sphere's centre. `kExpectHits` saves the branch that ends a test which no lane passes.
template <class L, bool kExpectHits = false>
[[gnu::always_inline]] inline SurfaceHit<L> intersect_sphere(const RayPacket<L>& ray, const typename L::Float (&from)[3], typename L::Float radius) noexcept {
  using Float = typename L::Float;
  const Float zero(0.0f);
  const Float f_dir = L::mul_add(from[2], ray.dir[2], L::mul_add(from[1], ray.dir[1], from[0] * ray.dir[0]));
  const Float closest = -f_dir * ray.inv_length2;
  const Float across[3] = {L::mul_add(closest, ray.dir[0], from[0]), L::mul_add(closest, ray.dir[1], from[1]), L::mul_add(closest, ray.dir[2], from[2])};
  const Float across2 = L::mul_add(across[2], across[2], L::mul_add(across[1], across[1], across[0] * across[0]));
  const Float chord2 = radius * radius - across2;
  SurfaceHit<L> hit{chord2 >= zero, zero, zero, zero};
  if (!kExpectHits && L::none(hit.meets)) return hit;

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
inline SurfaceHit<L> intersect_sphere(const RayPacket<L>& ray, const SphereView& pool, std::int32_t i) noexcept {
  using Float = typename L::Float;
  const Float from[3] = {ray.org[0] - Float(pool.center[0][i]), ray.org[1] - Float(pool.center[1][i]), ray.org[2] - Float(pool.center[2][i])};
  return intersect_sphere<L>(ray, from, Float(pool.radius[i]));
}

}  // namespace raymeter
