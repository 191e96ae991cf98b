#pragma once

// Ray against an open cone or cylinder (NFF's `c`: no caps), seen from both sides. The quadratic is set up at the ray's closest approach to the axis, found in
// two steps: to the middle of the axis, so that coordinates have the cone's own scale whatever the distance of the eye, then to its line, so that the roots lie
// on either side at the scale of the radius there (a discriminant taken further away cancels: near a thin apex by length^2 / radius).
// The smaller root comes from the product of the roots.
//
// Error: as for the sphere, P lies within about 8 roundings of (|P - org| + cone size) of the cone. Boundary band: that distance around silhouette and rims.

#include "core/ray/ray_packet.h"
#include "core/scene/pools_view.h"

namespace raymeter {

template <class L>
inline SurfaceHit<L> intersect_cone(const RayPacket<L>& ray, const HitPacket<L>& nearest, const ConeView& pool, std::int32_t i) noexcept {
  using Float = typename L::Float;
  using Mask = typename L::Mask;
  const Float zero(0.0f), one(1.0f);
  const auto dot = [](const Float* p, const Float* q) noexcept { return L::mul_add(p[2], q[2], L::mul_add(p[1], q[1], p[0] * q[0])); };

  const Float radius(pool.radius[0][i]);
  const Float taper(pool.radius[1][i] - pool.radius[0][i]);
  Float axis[3], from_base[3], from_middle[3];
  for (int a = 0; a < 3; ++a) {
    axis[a] = Float(pool.axis[a][i]);
    from_base[a] = ray.org[a] - Float(pool.base[a][i]);
    from_middle[a] = L::neg_mul_add(Float(0.5f), axis[a], from_base[a]);
  }
  const Float to_middle = -dot(from_middle, ray.dir) * ray.inv_length2;
  const Float inv_axis2 = one / dot(axis, axis);

  Float p[3];  // the closest approach to the middle, seen from the base
  for (int a = 0; a < 3; ++a) p[a] = L::mul_add(to_middle, ray.dir[a], from_base[a]);
  const Float height_there = dot(p, axis) * inv_axis2;  // 0 at the base, 1 at the apex
  const Float climb = dot(ray.dir, axis) * inv_axis2;   // its change per unit of t
  Float w[3], v[3];                                     // off the axis, and its change per unit of t
  for (int a = 0; a < 3; ++a) {
    w[a] = L::neg_mul_add(height_there, axis[a], p[a]);
    v[a] = L::neg_mul_add(climb, axis[a], ray.dir[a]);
  }
  const Float to_line = -dot(w, v) / dot(v, v);
  // Not further than the axis is long: of rays nearly along it (0 / 0 where exactly so) the closest approach is elsewhere, and the roots are far apart.
  const Float shift = L::select(L::abs(to_line * climb) <= one, to_line, zero);
  const Float closest = to_middle + shift;
  const Float height = L::mul_add(shift, climb, height_there);
  for (int a = 0; a < 3; ++a) w[a] = L::mul_add(shift, v[a], w[a]);
  const Float radius_here = L::mul_add(taper, height, radius);
  const Float narrowing = taper * climb;
  const Float quadratic = L::neg_mul_add(narrowing, narrowing, dot(v, v));
  const Float linear = L::neg_mul_add(narrowing, radius_here, dot(w, v));
  const Float off_axis = L::sqrt(dot(w, w));
  const Float constant = (off_axis - radius_here) * (off_axis + radius_here);
  const Float discriminant = L::difference_of_products(linear, linear, quadratic, constant);
  SurfaceHit<L> hit;
  hit.meets = discriminant >= zero;
  if (L::none(hit.meets)) return hit;

  const Float root = L::sqrt(L::max(discriminant, zero));
  const Float q = -(linear + L::select(linear < zero, -root, root));
  const Float s1 = q / quadratic;
  const Float s2 = constant / q;
  const auto on_cone = [&](Float s) noexcept -> Mask {
    const Float y = L::mul_add(s, climb, height);
    return (y >= zero) & (y <= one);
  };
  const auto in_ray = [&](Float t) noexcept -> Mask { return (t >= ray.t_min) & (t <= nearest.t); };
  const Float t1 = closest + s1;
  const Float t2 = closest + s2;
  const Mask first = on_cone(s1) & in_ray(t1);
  const Mask second = on_cone(s2) & in_ray(t2);
  hit.meets = hit.meets & (first | second);
  hit.t = L::select(first & (~second | (t1 < t2)), t1, t2);
  hit.u = zero;
  hit.v = zero;
  return hit;
}

}  // namespace raymeter
