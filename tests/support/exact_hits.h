#pragma once

// Whether the point of a hit keeps the promises of core/geometry/error_bounds.h; exact, by the numbers of the oracle.

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/bounds/aabb.h"
#include "core/geometry/error_bounds.h"
#include "experiments/verify/polygon_truth.h"
#include "experiments/verify/triangle_truth.h"

namespace raymeter::test {

/// The point org + t dir in numbers that decide.
template <class N>
verify::Vec<N> point_at(const Ray& ray, double t) {
  verify::Vec<N> p = verify::vec<N>(ray.org);
  for (std::size_t a = 0; a < 3; ++a) p[a] = p[a] + N(t) * N(double{ray.dir[a]});
  return p;
}

/// Whether the point of a hit is as near to its box as is promised: exact.
inline bool near_box(const Aabb& box, const Ray& ray, double t) {
  using namespace verify;
  return decide(Arithmetic::filtered, [&]<class N>() {
    const Vec<N> p = point_at<N>(ray, t);
    N extent(0.0);
    for (glm::length_t a = 0; a < 3; ++a) extent = larger(extent, N(N(double{box.max[a]}) - N(double{box.min[a]})));
    for (std::size_t a = 0; a < 3; ++a) {
      const auto axis = static_cast<glm::length_t>(a);
      const N room = N(double{kPrimitiveError}) * (N(std::abs(t)) * N(std::abs(double{ray.dir[a]})) + extent);
      if (sign(N(p[a] - N(double{box.min[axis]}) + room)) < 0 || sign(N(N(double{box.max[axis]}) - p[a] + room)) < 0) return false;
    }
    return true;
  });
}

/// Whether org + t dir is within `reach` of a point of the triangle: exact for that point, which is the nearest one but for roundings.
inline bool near_triangle(const verify::TriangleShape& triangle, const Ray& ray, double t, double reach) {
  using namespace verify;
  const Point a = point(triangle.vertex[0]), e = minus(point(triangle.vertex[1]), a), f = minus(point(triangle.vertex[2]), a);
  const Point to = minus(along(point(ray.org), t, point(ray.dir)), a);
  std::vector<std::array<double, 2>> places{{0, 0}};  // weights of e and f
  const auto on_edge = [&](const std::array<double, 2>& from, const std::array<double, 2>& way) {
    const Point start = along(along({0, 0, 0}, from[0], e), from[1], f), edge = along(along({0, 0, 0}, way[0], e), way[1], f);
    const double s = dot(edge, edge) > 0 ? std::clamp(dot(minus(to, start), edge) / dot(edge, edge), 0.0, 1.0) : 0.0;
    places.push_back({from[0] + s * way[0], from[1] + s * way[1]});
  };
  on_edge({0, 0}, {1, 0});
  on_edge({0, 0}, {0, 1});
  on_edge({1, 0}, {-1, 1});
  const double ee = dot(e, e), ef = dot(e, f), ff = dot(f, f), area2 = ee * ff - ef * ef;
  if (area2 > 0) {
    const double u = std::clamp((ff * dot(to, e) - ef * dot(to, f)) / area2, 0.0, 1.0);
    places.push_back({u, std::clamp((ee * dot(to, f) - ef * dot(to, e)) / area2, 0.0, 1 - u)});
  }
  return std::ranges::any_of(places, [&](const std::array<double, 2>& place) {
    return decide(Arithmetic::filtered, [&]<class N>() {
      const N u(place[0] * (1 - 0x1p-50)), v(place[1] * (1 - 0x1p-50));  // a sum of 1 may be rounded up
      if (sign(u) < 0 || sign(v) < 0 || sign(N(N(1.0) - u - v)) < 0) return false;
      const Vec<N> from = vec<N>(triangle.vertex[0]), b = vec<N>(triangle.vertex[1]) - from, c = vec<N>(triangle.vertex[2]) - from;
      Vec<N> off = point_at<N>(ray, t) - from;
      for (std::size_t k = 0; k < 3; ++k) off[k] = off[k] - u * b[k] - v * c[k];
      return sign(N(N(reach) * N(reach) - dot(off, off))) >= 0;
    });
  });
}

/// Whether org + t dir is within `reach` of the polygon's plane, or along the ray of where that meets the box, if the box cuts it off.
inline bool near_polygon(const verify::PolygonShape& polygon, const Ray& ray, double t, double reach) {
  using namespace verify;
  return decide(Arithmetic::filtered, [&]<class N>() {
    const float first[3] = {polygon.vertex[0][0], polygon.vertex[0][1], polygon.vertex[0][2]};
    const Vec<N> org = vec<N>(ray.org), dir = vec<N>(ray.dir), normal = vec<N>(polygon.normal);
    const N height = dot(normal, vec<N>(first) - org), slope = dot(normal, dir), off = height - N(t) * slope;
    if (sign(N(N(reach) * N(reach) * dot(normal, normal) - off * off)) >= 0) return true;
    N near(-1e30), far(1e30);
    for (std::size_t a = 0; a < 3; ++a) {
      if (sign(dir[a]) == 0) continue;
      const auto [low, high] = std::minmax_element(polygon.vertex.begin(), polygon.vertex.end(), [a](const auto& v, const auto& w) { return v[a] < w[a]; });
      const N t0 = (N(double{(*low)[a]}) - org[a]) / dir[a], t1 = (N(double{(*high)[a]}) - org[a]) / dir[a];
      near = larger(near, smaller(t0, t1));
      far = smaller(far, larger(t0, t1));
    }
    if (sign(N(far - near)) < 0) std::swap(near, far);  // the ray passes beside the box: between the ends that fail to meet
    const N meant = sign(slope) == 0 ? near : N(height / slope);
    const N late = N(t) - near, early = far - N(t);
    const N beyond = sign(N(meant - near)) < 0 ? late : sign(N(meant - far)) > 0 ? early : N(N(t) - meant);
    const bool cut = sign(N(meant - near)) < 0 || sign(N(meant - far)) > 0;
    return (cut && sign(beyond) <= 0) || sign(N(N(reach) * N(reach) - beyond * beyond * dot(dir, dir))) >= 0;
  });
}

}  // namespace raymeter::test
