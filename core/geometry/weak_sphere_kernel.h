#pragma once

// Sphere tests without the guards of sphere_kernel.h, as published.
//   naive   b^2 - a c and both roots by the school formula: cancels for far, small and huge spheres.
//   haines  Haines, Guenther, Akenine-Moeller 2019 (Ray Tracing Gems, ch. 7): discriminant from the closest approach, nearer root c / q; c itself cancels for
//           huge spheres, and nothing keeps the hit inside the sphere's box.

#include "core/ray/ray_packet.h"
#include "core/scene/pools_view.h"

namespace raymeter {

/// kCloseUp: the discriminant from the closest approach and the stable roots.
template <bool kCloseUp, class L>
[[gnu::always_inline]] inline SurfaceHit<L> weak_sphere(const RayPacket<L>& ray, const SphereView& pool, std::int32_t i) noexcept {
  using Float = typename L::Float;
  const Float zero(0.0f), radius(pool.radius[i]);
  const Float f[3] = {ray.org[0] - Float(pool.center[0][i]), ray.org[1] - Float(pool.center[1][i]), ray.org[2] - Float(pool.center[2][i])};
  const auto dot = [](const Float(&a)[3], const Float(&b)[3]) noexcept { return L::mul_add(a[2], b[2], L::mul_add(a[1], b[1], a[0] * b[0])); };
  const Float b = -dot(f, ray.dir), c = dot(f, f) - radius * radius, length2 = dot(ray.dir, ray.dir);
  Float discriminant = b * b - length2 * c;
  if constexpr (kCloseUp) {
    const Float closest = b * ray.inv_length2;
    const Float across[3] = {L::mul_add(closest, ray.dir[0], f[0]), L::mul_add(closest, ray.dir[1], f[1]), L::mul_add(closest, ray.dir[2], f[2])};
    discriminant = length2 * (radius * radius - dot(across, across));
  }
  SurfaceHit<L> hit{discriminant >= zero, zero, zero, zero};
  if (L::none(hit.meets)) return hit;
  const Float root = L::sqrt(L::max(discriminant, zero));
  Float enter = (b - root) * ray.inv_length2, leave = (b + root) * ray.inv_length2;
  if constexpr (kCloseUp) {
    const Float q = b + L::select(b < zero, -root, root);
    const Float one_root = L::select(q == zero, zero, c / q), other_root = q * ray.inv_length2;
    enter = L::min(one_root, other_root);
    leave = L::max(one_root, other_root);
  }
  hit.t = L::select(enter >= ray.t_min, enter, leave);
  return hit;
}

}  // namespace raymeter
