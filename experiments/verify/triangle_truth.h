#pragma once

#include "core/scene/pools.h"
#include "experiments/verify/true_hits.h"

namespace raymeter::verify {

struct TriangleShape {
  float vertex[3][3];
};
[[nodiscard]] TriangleShape triangle_at(const Pools& pools, std::size_t i) noexcept;

/// Edges and vertices belong to it. A ray in its plane misses, and so does every ray where its area is zero.
[[nodiscard]] TrueHits true_hits(const Ray& ray, const TriangleShape& triangle, Arithmetic arithmetic = Arithmetic::filtered);
/// Distance of `p` from the triangle.
[[nodiscard]] double distance(const TriangleShape& triangle, const Point& p) noexcept;

}  // namespace raymeter::verify
