#pragma once

#include "core/scene/pools.h"
#include "experiments/verify/true_hits.h"

namespace raymeter::verify {

/// An open cone or cylinder from `base` to base + axis. Where the axis is zero there is no surface.
struct ConeShape {
  float base[3];
  float axis[3];
  float radius[2];
};
[[nodiscard]] ConeShape cone_at(const Pools& pools, std::size_t i) noexcept;

/// A ray that lies in the surface misses it, as one in the plane of a triangle does.
[[nodiscard]] TrueHits true_hits(const Ray& ray, const ConeShape& cone, Arithmetic arithmetic = Arithmetic::filtered);
/// Distance of `p` from the surface, rims included.
[[nodiscard]] double distance(const ConeShape& cone, const Point& p) noexcept;
/// Whether a ray moved by `shift` might miss the hit at t: it is near a rim, or near the silhouette.
[[nodiscard]] bool near_border(const ConeShape& cone, const Point& org, const Point& dir, double t, double shift) noexcept;
/// t where the line may come nearest to the surface without meeting it: the middle of the chord, the ends of the height.
[[nodiscard]] std::array<double, 5> near_approaches(const ConeShape& cone, const Point& org, const Point& dir) noexcept;

}  // namespace raymeter::verify
