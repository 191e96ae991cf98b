#pragma once

// Ray against an open cone or cylinder (NFF's `c`: no caps), seen from both sides. The quadratic is set up where the ray is nearest to the axis: whatever the
// distance of the eye and however slender the cone, everything there has the size of its radius. Where that is far beyond an end, as for rays nearly along the
// axis, it is set up at that end; where the ray is steeper than the side, at the apex, about which both roots lie and nothing cancels, even on the axis
// itself. The smaller root comes from the product of the roots.
//
// Error: the reference point is off by 3 roundings of |P - org| + size, its parts across the axis by 3 of the size, the direction's by 2 of |dir|; over the way
// to the hit, which is inside the cone, the coefficients' errors add up to 25 roundings of the size, t adds 2 of |P - org|: together within kSurfaceError.
// t is clamped to the ray's interval in the cone's own box, so that P keeps kPrimitiveError. Boundary band: kSurfaceError around silhouette, rims and apex.
// A ray that lies in the surface misses where nothing is rounded, but may be met; every ray misses where the axis is zero.

#include "core/bounds/slab_kernel.h"
#include "core/ray/ray_packet.h"
#include "core/scene/pools_view.h"

namespace raymeter {

template <class L>
inline SurfaceHit<L> intersect_cone(const RayPacket<L>& ray, const HitPacket<L>& nearest, const ConeView& pool, std::int32_t i) noexcept {
  using Float = typename L::Float;
  using Mask = typename L::Mask;
  const Float zero(0.0f), one(1.0f);
  const SlabInterval<L> in_box = line_in_own_box<L>(ray, pool.box_min, pool.box_max, i);
  SurfaceHit<L> hit;
  hit.meets = L::max(in_box.t_near, ray.t_min) <= L::min(in_box.t_far, nearest.t);
  if (L::none(hit.meets)) return hit;

  const auto dot = [](const Float* p, const Float* q) noexcept { return L::mul_add(p[2], q[2], L::mul_add(p[1], q[1], p[0] * q[0])); };
  const Float radius(pool.radius[0][i]);
  const Float taper(pool.radius[1][i] - pool.radius[0][i]);
  Float axis[3], from_base[3], from_middle[3];
  for (int a = 0; a < 3; ++a) {
    axis[a] = Float(pool.axis[a][i]);
    from_base[a] = ray.org[a] - Float(pool.base[a][i]);
    from_middle[a] = L::neg_mul_add(Float(0.5f), axis[a], from_base[a]);
  }
  const Float inv_axis2 = one / dot(axis, axis);
  const Float climb = dot(ray.dir, axis) * inv_axis2;  // change of height per unit of t
  Float v[3], w[3];                                    // across the axis: direction, and the point at t
  for (int a = 0; a < 3; ++a) v[a] = L::neg_mul_add(climb, axis[a], ray.dir[a]);
  /// Height of the point at t, 0 at the base, 1 at the apex; leaves its part across the axis in w.
  const auto height_at = [&](Float t) noexcept {
    Float p[3];
    for (int a = 0; a < 3; ++a) p[a] = L::mul_add(t, ray.dir[a], from_base[a]);
    const Float height = dot(p, axis) * inv_axis2;
    for (int a = 0; a < 3; ++a) w[a] = L::neg_mul_add(height, axis[a], p[a]);
    return height;
  };
  const auto in_cone = [&](Float y) noexcept -> Mask { return (y >= zero) & (y <= one); };

  const Float narrowing = taper * climb;
  const Float across2 = dot(v, v);
  // From the closest approach to the middle on to that to the axis, or to the end: a ray that meets the cone but passes the axis beyond -1..2 climbs steeply.
  const Float near_middle = -dot(from_middle, ray.dir) * ray.inv_length2;
  const Float middle_height = height_at(near_middle);
  const Float to_axis = -dot(w, v) / across2;
  const Float axis_height = L::mul_add(to_axis, climb, middle_height);
  const auto near_cone = [&](Float y) noexcept -> Mask { return (y >= -one) & (y <= Float(2.0f)); };
  const Float apex_height = -radius / taper;
  const Mask about_apex = (Float(4.0f) * across2 < narrowing * narrowing) & near_cone(apex_height);
  const Float to_height = (L::select(about_apex, apex_height, L::min(L::max(axis_height, zero), one)) - middle_height) / climb;
  const Float reference = near_middle + L::select(~about_apex & near_cone(axis_height), to_axis, to_height);

  const Float height = height_at(reference);
  const Float radius_here = L::mul_add(taper, height, radius);
  const Float quadratic = L::neg_mul_add(narrowing, narrowing, across2);
  const Float linear = L::neg_mul_add(narrowing, radius_here, dot(w, v));
  const Float off_axis = L::sqrt(dot(w, w));
  const Float constant = (off_axis - radius_here) * (off_axis + radius_here);
  const Float discriminant = L::difference_of_products(linear, linear, quadratic, constant);
  hit.meets = hit.meets & (discriminant >= zero);
  if (L::none(hit.meets)) return hit;

  const Float root = L::sqrt(L::max(discriminant, zero));
  const Float q = -(linear + L::select(linear < zero, -root, root));
  const Float s1 = q / quadratic;
  const Float s2 = constant / q;
  const Float t1 = reference + s1;
  const Float t2 = reference + s2;
  const Mask first = in_cone(L::mul_add(s1, climb, height)) & (t1 >= ray.t_min);
  const Mask second = in_cone(L::mul_add(s2, climb, height)) & (t2 >= ray.t_min);
  hit.meets = hit.meets & (first | second);
  hit.t = L::min(L::max(L::select(first & (~second | (t1 < t2)), t1, t2), in_box.t_near), in_box.t_far);
  hit.u = zero;
  hit.v = zero;
  return hit;
}

}  // namespace raymeter
