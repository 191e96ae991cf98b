#pragma once

// Ray against a planar polygon of any number of vertices, concave or not, two-sided. Inside is decided in ray space by crossing parity with exact signs, so it
// is watertight against neighbouring polygons and triangles; a point on the outline is inside (closed sets). t comes from the plane through vertex 0.
//
// Error: t of the plane is off by a few roundings of the distance divided by the cosine of the incidence; it is clamped to the interval in which the ray is
// inside the polygon's own box, so that P keeps kPrimitiveError at any angle. Boundary band: 3 roundings of the vertex distances.

#include "core/bounds/slab_kernel.h"
#include "core/ray/ray_packet.h"
#include "core/geometry/triangle_kernel.h"
#include "core/scene/pools_view.h"

namespace raymeter {

template <class L>
inline SurfaceHit<L> intersect_polygon(const RayPacket<L>& ray, const HitPacket<L>& nearest, const PolygonView& pool, std::int32_t i) noexcept {
  using Float = typename L::Float;
  using Mask = typename L::Mask;
  const Float zero(0.0f);
  const float box[6] = {pool.box_min[0][i], pool.box_min[1][i], pool.box_min[2][i], pool.box_max[0][i], pool.box_max[1][i], pool.box_max[2][i]};
  const SlabInterval<L> in_box = line_in_box<L>(ray, box);
  SurfaceHit<L> hit;
  hit.meets = L::max(in_box.t_near, ray.t_min) <= L::min(in_box.t_far, nearest.t);
  if (L::none(hit.meets)) return hit;

  const std::int32_t first = pool.first_vertex[i];
  const std::int32_t last = pool.first_vertex[i + 1] - 1;
  ShearedVertex<L> a = shear(ray, pool.vertex, last);
  Mask odd = hit.meets & ~hit.meets;
  Mask on_outline = odd;
  for (std::int32_t k = first; k <= last; ++k) {
    const ShearedVertex<L> b = shear(ray, pool.vertex, k);
    const Float side = L::difference_of_products(a.x, b.y, a.y, b.x);
    const Mask up = (a.y <= zero) & (b.y > zero);
    const Mask down = (b.y <= zero) & (a.y > zero);
    const Mask crosses = (up & (side > zero)) | (down & (side < zero));
    odd = (odd & ~crosses) | (crosses & ~odd);
    const Mask spans = (L::min(a.x, b.x) <= zero) & (L::max(a.x, b.x) >= zero) & (L::min(a.y, b.y) <= zero) & (L::max(a.y, b.y) >= zero);
    on_outline = on_outline | (spans & (side == zero));
    a = b;
  }
  const Float n[3] = {Float(pool.normal[0][i]), Float(pool.normal[1][i]), Float(pool.normal[2][i])};
  Float height = zero, slope = zero;
  for (int axis = 0; axis < 3; ++axis) {
    height = L::mul_add(n[axis], Float(pool.vertex[axis][first]) - ray.org[axis], height);
    slope = L::mul_add(n[axis], ray.dir[axis], slope);
  }
  hit.meets = hit.meets & (odd | on_outline) & (slope != zero);
  hit.t = L::min(L::max(height / slope, in_box.t_near), in_box.t_far);
  hit.u = zero;
  hit.v = zero;
  return hit;
}

}  // namespace raymeter
