#pragma once

// Ray against sphere, without cancellation near, far and huge: Haines, Guenther, Akenine-Moeller 2019 (Ray Tracing Gems, ch. 7). The discriminant comes from
// the vector that is perpendicular to the ray at its closest approach; the nearer root is c / q, c in the factored form (|f| - r)(|f| + r), good for huge radii.
//
// Error: an error along the ray of the closest approach changes the perpendicular only in second order, so P lies within about 6 roundings of
// (|P - org| + r) of the sphere. Boundary band: rays that pass within that of the silhouette.

#include "core/ray/ray_packet.h"
#include "core/scene/pools_view.h"

namespace raymeter {

template <class L>
inline SurfaceHit<L> intersect_sphere(const RayPacket<L>& ray, const HitPacket<L>& nearest, const SphereView& pool, std::int32_t i) noexcept {
  using Float = typename L::Float;
  const Float zero(0.0f);
  const Float radius(pool.radius[i]);
  const Float f[3] = {ray.org[0] - Float(pool.center[0][i]), ray.org[1] - Float(pool.center[1][i]), ray.org[2] - Float(pool.center[2][i])};
  const Float f_dir = L::mul_add(f[2], ray.dir[2], L::mul_add(f[1], ray.dir[1], f[0] * ray.dir[0]));
  const Float closest = -f_dir * ray.inv_length2;
  const Float across[3] = {L::mul_add(closest, ray.dir[0], f[0]), L::mul_add(closest, ray.dir[1], f[1]), L::mul_add(closest, ray.dir[2], f[2])};
  const Float across2 = L::mul_add(across[2], across[2], L::mul_add(across[1], across[1], across[0] * across[0]));
  const Float chord2 = radius * radius - across2;
  SurfaceHit<L> hit;
  hit.meets = chord2 >= zero;
  if (L::none(hit.meets)) return hit;

  const Float half_chord = L::sqrt(L::max(chord2, zero) * ray.inv_length2);
  // The root of larger magnitude is a plain sum; the other follows from the product of the roots, c / dir^2.
  const Float far_root = closest + L::select(closest < zero, -half_chord, half_chord);
  const Float distance = L::sqrt(L::mul_add(f[2], f[2], L::mul_add(f[1], f[1], f[0] * f[0])));
  const Float product = (distance - radius) * (distance + radius) * ray.inv_length2;
  const Float near_root = L::select(far_root == zero, zero, product / far_root);
  const Float t_enter = L::min(near_root, far_root);
  const Float t_exit = L::max(near_root, far_root);
  const auto enters = (t_enter >= ray.t_min) & (t_enter <= nearest.t);
  hit.t = L::select(enters, t_enter, t_exit);
  hit.u = zero;
  hit.v = zero;
  return hit;
}

}  // namespace raymeter
