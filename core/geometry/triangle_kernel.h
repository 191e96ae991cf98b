#pragma once

// Ray against triangle, watertight at edges and vertices: Woop, Benthin, Wald 2013 (JCGT 2(1)), with differences of products whose sign is exact
// (FMA, or double where the instruction set has none), so that no edge needs a second look. Two-sided; what is seen without an area (det = 0) is missed.
// Vertices in ray space are a function of ray and vertex alone: triangles that share an edge see the same and decide alike. A triangle in whose plane the ray
// lies is met if it is seen with an area, as it is where the shear rounds: it may be all that is seen around the ray, and without it there would be a hole.
// Error, u = kUnitRoundoff, A = vertex - org, S the shear: a vertex is seen across the ray within u (2 |A_p| + 4 |S A_z|) per axis p (one less with FMA); that
// is below kSeenVertexError |A|, the boundary band. With the weights w of these, Q = sum w V is a point of the triangle, and the ray passes Q within their
// weighted mean. t starts from vertex a, so that what weights are off, 8 u, counts for differences of depth alone: with s the spread of z', t is at any angle
// in 5 u |t| + 12 u s of Q's depth, of which 3 u (|t| + s / 2) are the vertices', u (|t| + s) and u |t| the sums'. With sum w |A_p| <= |P - org|_p + extent /
// 2, P is outside the box by at most 11 u |P - org|_p + 15 u extent: less than kPrimitiveError. Triangles are met where twice the area that is seen of them is
// 2^-126 or more, and all this holds from 2^-122 on: what underflows makes a sign 0 at most, never wrong, so that no edge between triangles that are met leaks.

#include "core/ray/ray_packet.h"
#include "core/scene/pools_view.h"

namespace raymeter {

/// A vertex in the space of each ray: x', y' across, z' along it in units of t.
template <class L>
struct ShearedVertex {
  typename L::Float x;
  typename L::Float y;
  typename L::Float z;
};

/// Brings vertex `i` of the columns x, y, z into ray space.
template <class L>
[[gnu::always_inline]] inline ShearedVertex<L> shear(const RayPacket<L>& ray, const float* const* column, std::int32_t i) noexcept {
  using Float = typename L::Float;
  Float p, q, r;
  if (ray.axis >= 0) {
    constexpr int next[5] = {0, 1, 2, 0, 1};
    p = Float(column[next[ray.axis + 1]][i]);
    q = Float(column[next[ray.axis + 2]][i]);
    r = Float(column[ray.axis][i]);
  } else {
    const Float x(column[0][i]), y(column[1][i]), z(column[2][i]);
    p = L::select(ray.axis_is_z, x, L::select(ray.axis_is_y, z, y));
    q = L::select(ray.axis_is_z, y, L::select(ray.axis_is_y, x, z));
    r = L::select(ray.axis_is_z, z, L::select(ray.axis_is_y, y, x));
  }
  const Float depth = r - ray.shear_org[2];
  return {L::neg_mul_add(ray.shear[0], depth, p - ray.shear_org[0]), L::neg_mul_add(ray.shear[1], depth, q - ray.shear_org[1]), ray.shear[2] * depth};
}

/// The triangle of three vertices in ray space. `kExpectHits` saves the branch that ends a test which no lane passes.
template <class L, bool kExpectHits = false>
[[gnu::always_inline]] inline SurfaceHit<L> intersect_triangle(const ShearedVertex<L>& a, const ShearedVertex<L>& b, const ShearedVertex<L>& c) noexcept {
  using Float = typename L::Float;
  const Float zero(0.0f);
  if constexpr (!kExpectHits && L::kIsa < Isa::avx2) {
    // Most triangles are missed. Rounding is monotone: plain differences have the exact ones' signs, and above 2^-120 weights do not round to 0 below.
    const Float rounded_a = c.x * b.y - c.y * b.x, rounded_b = a.x * c.y - a.y * c.x, rounded_c = b.x * a.y - b.y * a.x, least_sure(0x1p-120f);
    const auto passes_by = (L::min(L::min(rounded_a, rounded_b), rounded_c) < -least_sure) & (L::max(L::max(rounded_a, rounded_b), rounded_c) > least_sure);
    if (L::all(passes_by)) return {~passes_by, zero, zero, zero};
  }
  const Float weight_a = L::difference_of_products(c.x, b.y, c.y, b.x);
  const Float weight_b = L::difference_of_products(a.x, c.y, a.y, c.x);
  const Float weight_c = L::difference_of_products(b.x, a.y, b.y, a.x);
  const Float least = L::min(L::min(weight_a, weight_b), weight_c);
  const Float most = L::max(L::max(weight_a, weight_b), weight_c);
  const Float det = weight_a + weight_b + weight_c;
  SurfaceHit<L> hit{{}, zero, zero, zero};
  // What is seen so nearly edge-on that 1 / det is no float is not seen.
  hit.meets = ((least >= zero) | (most <= zero)) & (L::abs(det) >= Float(0x1p-126f));
  if (!kExpectHits && L::none(hit.meets)) return hit;
  const Float inv_det = Float(1.0f) / det;
  // At a vertex t is that vertex's in all triangles that share it, so that the tie goes to the smallest id. Where all three are equally deep, t is that depth.
  const auto at_b = weight_b == det, at_c = weight_c == det;
  hit.u = L::select(at_b, Float(1.0f), weight_b * inv_det);
  hit.v = L::select(at_c, Float(1.0f), weight_c * inv_det);
  const Float inside = L::mul_add(hit.v, c.z - a.z, L::mul_add(hit.u, b.z - a.z, a.z));
  hit.t = L::select(at_b, b.z, L::select(at_c, c.z, inside));
  return hit;
}

template <class L>
[[gnu::always_inline]] inline SurfaceHit<L> intersect_triangle(const RayPacket<L>& ray, const TriangleView& pool, std::int32_t triangle) noexcept {
  const std::int32_t i = triangle * pool.stride;
  return intersect_triangle<L>(shear(ray, pool.vertex[0], i), shear(ray, pool.vertex[1], i), shear(ray, pool.vertex[2], i));
}

}  // namespace raymeter
