#include "experiments/verify/sphere_truth.h"

namespace raymeter::verify {

SphereShape sphere_at(const Pools& pools, std::size_t i) noexcept {
  const SpherePool& pool = pools.spheres;
  return {{pool.center[0][i], pool.center[1][i], pool.center[2][i]}, pool.radius[i]};
}

TrueHits true_hits(const Ray& ray, const SphereShape& sphere, Arithmetic arithmetic) {
  return decide(arithmetic, [&]<class N>() {
    const NumberRay<N> r(ray);
    const Vec<N> from_center = r.org - vec<N>(sphere.center);
    const N radius2 = N(double{sphere.radius}) * N(double{sphere.radius});
    const Vec<N> moment = cross(from_center, r.dir);
    const N a = dot(r.dir, r.dir);
    const Quadratic<N> f{a, dot(from_center, r.dir), dot(from_center, from_center) - radius2, radius2 * a - dot(moment, moment)};
    TrueHits hits;
    const int meets = sign(f.discriminant);
    if (meets < 0) return hits;
    for (const int side : {-1, 1}) {
      if (side == 1 && meets == 0) break;  // one point of contact
      if (r.has_min && f.sign_at(side, N(-r.t_min), N(1.0)) < 0) continue;
      if (r.has_max && f.sign_at(side, N(-r.t_max), N(1.0)) > 0) continue;
      hits.add(f.root(side));
    }
    return hits;
  });
}

double distance(const SphereShape& sphere, const Point& p) noexcept { return std::abs(length(minus(p, point(sphere.center))) - double{sphere.radius}); }

double depth_inside(const SphereShape& sphere, const Point& org, const Point& dir) noexcept {
  const Point from_center = minus(org, point(sphere.center));
  return double{sphere.radius} - length(along(from_center, -dot(from_center, dir) / dot(dir, dir), dir));
}

}  // namespace raymeter::verify
