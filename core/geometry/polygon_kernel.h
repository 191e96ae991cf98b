#pragma once

// Ray against a planar polygon of any number of vertices, concave or not, two-sided. Inside is decided in ray space by crossing parity with exact signs, so it
// is watertight against neighbouring polygons and triangles; a point on the outline is inside (closed sets). t comes from the plane through vertex 0.
//
// Error: P is within 8 roundings of |P - org| + size of the plane through vertex 0 with the stored normal. At grazing incidence that says little along the ray,
// so t is clamped to the interval in which the ray is inside the polygon's own box: that keeps kPrimitiveError at any angle. The ray that is decided on passes
// within 6 roundings of |P - org| and 3 of the extent of the given one (see the triangle), which the padding of that box covers: it takes no hit away that
// the outline grants. Boundary band: kSeenVertexError. It is missed if it is seen without an area; a ray in its plane may see one.

#include "core/bounds/slab_kernel.h"
#include "core/geometry/triangle_kernel.h"
#include "core/ray/ray_packet.h"
#include "core/scene/pools_view.h"

namespace raymeter {

template <class L>
inline SurfaceHit<L> intersect_polygon(const RayPacket<L>& ray, const HitPacket<L>& nearest, const PolygonView& pool, std::int32_t i) noexcept {
  using Float = typename L::Float;
  using Mask = typename L::Mask;
  const Float zero(0.0f);
  const SlabInterval<L> in_box = line_in_own_box<L>(ray, pool.box_min, pool.box_max, i);
  SurfaceHit<L> hit;
  hit.meets = L::max(in_box.t_near, ray.t_min) <= L::min(in_box.t_far, nearest.t);
  if (L::none(hit.meets)) return hit;

  const std::int32_t first = pool.first_vertex[i];
  const std::int32_t last = pool.first_vertex[i + 1] - 1;
  ShearedVertex<L> a = shear(ray, pool.vertex, last);
  Mask odd = hit.meets & ~hit.meets;
  Mask on_outline = odd;
  Mask has_area = odd;
  for (std::int32_t k = first; k <= last; ++k) {
    const ShearedVertex<L> b = shear(ray, pool.vertex, k);
    const Float side = L::difference_of_products(a.x, b.y, a.y, b.x);
    const Mask up = (a.y <= zero) & (b.y > zero);
    const Mask down = (b.y <= zero) & (a.y > zero);
    const Mask crosses = (up & (side > zero)) | (down & (side < zero));
    odd = (odd & ~crosses) | (crosses & ~odd);
    const Mask spans = (L::min(a.x, b.x) <= zero) & (L::max(a.x, b.x) >= zero) & (L::min(a.y, b.y) <= zero) & (L::max(a.y, b.y) >= zero);
    on_outline = on_outline | (spans & (side == zero));
    has_area = has_area | (side != zero);
    a = b;
  }
  const Float n[3] = {Float(pool.normal[0][i]), Float(pool.normal[1][i]), Float(pool.normal[2][i])};
  Float height = zero, slope = zero;
  for (int axis = 0; axis < 3; ++axis) {
    height = L::mul_add(n[axis], Float(pool.vertex[axis][first]) - ray.org[axis], height);
    slope = L::mul_add(n[axis], ray.dir[axis], slope);
  }
  hit.meets = hit.meets & (odd | on_outline) & has_area;
  // A slope of zero leaves infinity or NaN, which the clamp drops.
  hit.t = L::min(L::max(height / slope, in_box.t_near), in_box.t_far);
  hit.u = zero;
  hit.v = zero;
  return hit;
}

}  // namespace raymeter
