#include "experiments/verify/cone_truth.h"

#include <algorithm>

namespace raymeter::verify {

namespace {

/// A point as seen from the axis: height along it from the base, distance from it, both in units of length.
struct AxisPoint {
  double height, off_axis;
};

AxisPoint seen_from_axis(const ConeShape& cone, const Point& p) noexcept {
  const Point axis = point(cone.axis), from_base = minus(p, point(cone.base));
  const double axis_length = length(axis);
  const double height = dot(from_base, axis) / axis_length;
  return {height, length(along(from_base, -height / axis_length, axis))};
}

/// Distance from the unbounded cone, negative inside.
double signed_distance(const ConeShape& cone, const Point& p) noexcept {
  const AxisPoint at = seen_from_axis(cone, p);
  const double axis_length = length(point(cone.axis));
  const double taper = double{cone.radius[1]} - double{cone.radius[0]};
  return (at.off_axis - (double{cone.radius[0]} + taper * at.height / axis_length)) * axis_length / std::hypot(axis_length, taper);
}

/// Coefficients of F(t) = a t^2 + 2 b t + c: distance from the axis squared minus radius squared, times the axis' length to the fourth.
template <class N>
Quadratic<N> quadratic(const NumberRay<N>& ray, const ConeShape& cone) {
  const Vec<N> axis = vec<N>(cone.axis), from_base = ray.org - vec<N>(cone.base);
  const N length2 = dot(axis, axis);
  const N taper = N(double{cone.radius[1]}) - N(double{cone.radius[0]});
  const N radius_here = N(double{cone.radius[0]}) * length2 + taper * dot(from_base, axis);
  const N narrowing = taper * dot(ray.dir, axis);
  const Vec<N> across = cross(from_base, axis), turning = cross(ray.dir, axis);
  const N a = length2 * dot(turning, turning) - narrowing * narrowing;
  const N b = length2 * dot(across, turning) - narrowing * radius_here;
  const N c = length2 * dot(across, across) - radius_here * radius_here;
  return {a, b, c, N(b * b - a * c)};
}

}  // namespace

ConeShape cone_at(const Pools& pools, std::size_t i) noexcept {
  const ConePool& pool = pools.cones;
  return {{pool.base[0][i], pool.base[1][i], pool.base[2][i]}, {pool.axis[0][i], pool.axis[1][i], pool.axis[2][i]}, {pool.radius[0][i], pool.radius[1][i]}};
}

TrueHits true_hits(const Ray& ray, const ConeShape& cone, Arithmetic arithmetic) {
  return decide(arithmetic, [&]<class N>() {
    TrueHits hits;
    const NumberRay<N> r(ray);
    const Vec<N> axis = vec<N>(cone.axis);
    const N length2 = dot(axis, axis);
    if (sign(length2) == 0) return hits;
    const N height = dot(r.org - vec<N>(cone.base), axis), climb = dot(r.dir, axis);  // of length2
    const Quadratic<N> f = quadratic(r, cone);
    if (sign(f.a) == 0) {
      if (sign(f.b) == 0) return hits;
      const N t = -f.c / (f.b + f.b);
      const N y = height + t * climb;
      if (r.contains(t, N(1.0)) && sign(y) >= 0 && sign(N(length2 - y)) >= 0) hits.add(sign(f.c) == 0 ? 0.0 : to_double(t));
      return hits;
    }
    const int meets = sign(f.discriminant);
    if (meets < 0) return hits;
    const int first = -sign(f.a);  // the side of the smaller root
    for (const int side : {first, -first}) {
      if (side == -first && meets == 0) break;
      if (r.has_min && f.sign_at(side, N(-r.t_min), N(1.0)) < 0) continue;
      if (r.has_max && f.sign_at(side, N(-r.t_max), N(1.0)) > 0) continue;
      if (f.sign_at(side, height, climb) < 0 || f.sign_at(side, N(height - length2), climb) > 0) continue;
      hits.add(f.root(side));
    }
    return hits;
  });
}

double distance(const ConeShape& cone, const Point& p) noexcept {
  const double axis_length = length(point(cone.axis));
  const double r0 = double{cone.radius[0]}, taper = double{cone.radius[1]} - r0;
  const AxisPoint at = seen_from_axis(cone, p);
  // In the half plane of height and distance from the axis the surface is a segment.
  const double s = std::clamp((at.height * axis_length + (at.off_axis - r0) * taper) / (axis_length * axis_length + taper * taper), 0.0, 1.0);
  return std::hypot(at.height - s * axis_length, at.off_axis - (r0 + s * taper));
}

std::array<double, 5> near_approaches(const ConeShape& cone, const Point& org, const Point& dir) noexcept {
  const Point axis = point(cone.axis), from_base = minus(org, point(cone.base));
  const double length2 = dot(axis, axis), taper = double{cone.radius[1]} - double{cone.radius[0]};
  const double climb = dot(dir, axis) / length2, height = dot(from_base, axis) / length2;
  const Point w = along(from_base, -height, axis), v = along(dir, -climb, axis);
  const double a = dot(v, v) - taper * climb * taper * climb;
  const double b = dot(w, v) - taper * climb * (double{cone.radius[0]} + taper * height);
  const double c = dot(w, w) - std::pow(double{cone.radius[0]} + taper * height, 2);
  const double spread = std::sqrt(std::fmax(b * b - a * c, 0.0));
  return {-b / a, (-b - spread) / a, (-b + spread) / a, -height / climb, (1 - height) / climb};
}

bool near_border(const ConeShape& cone, const Point& org, const Point& dir, double t, double shift) noexcept {
  // The chord's middle is its deepest point, up to a factor of 2: the distance is concave along it.
  const double middle = near_approaches(cone, org, dir)[0];
  if (!(std::abs(signed_distance(cone, along(org, middle, dir))) > 2 * shift)) return true;
  const double axis_length = length(point(cone.axis));
  const Point hit = along(org, t, dir);
  const AxisPoint at = seen_from_axis(cone, hit);
  if (at.off_axis <= 2 * shift) return true;  // at the apex
  // A shift of the surface by `shift` moves the hit along the ray by shift / steepness, and so its height.
  const double dir_length = length(dir);
  const double step = 2 * shift / dir_length;
  const double steepness = std::abs(signed_distance(cone, along(org, t + step, dir)) - signed_distance(cone, along(org, t - step, dir))) / (4 * shift);
  const double climb = std::abs(dot(dir, point(cone.axis))) / (axis_length * dir_length);
  const double margin = 2 * shift * (1 + climb / steepness);
  return !(at.height > margin && at.height < axis_length - margin);
}

}  // namespace raymeter::verify
