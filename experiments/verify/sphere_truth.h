#pragma once

#include "core/scene/pools.h"
#include "experiments/verify/true_hits.h"

namespace raymeter::verify {

struct SphereShape {
  float center[3];
  float radius;
};
[[nodiscard]] SphereShape sphere_at(const Pools& pools, std::size_t i) noexcept;

[[nodiscard]] TrueHits true_hits(const Ray& ray, const SphereShape& sphere, Arithmetic arithmetic = Arithmetic::filtered);
/// Distance of `p` from the surface.
[[nodiscard]] double distance(const SphereShape& sphere, const Point& p) noexcept;
/// How deep the line org + t dir dips into the sphere, at most; negative: it passes outside by that.
[[nodiscard]] double depth_inside(const SphereShape& sphere, const Point& org, const Point& dir) noexcept;

}  // namespace raymeter::verify
