#include "experiments/verify/triangle_truth.h"

#include <algorithm>

namespace raymeter::verify {

namespace {

double segment_distance(const Point& a, const Point& b, const Point& p) noexcept {
  const Point edge = minus(b, a), to = minus(p, a);
  const double length2 = dot(edge, edge);
  return length(along(to, length2 > 0 ? -std::clamp(dot(to, edge) / length2, 0.0, 1.0) : 0.0, edge));
}

Point cross_product(const Point& a, const Point& b) noexcept { return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}; }

}  // namespace

TriangleShape triangle_at(const Pools& pools, std::size_t i) noexcept {
  TriangleShape shape;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t a = 0; a < 3; ++a) shape.vertex[k][a] = pools.triangles.vertex[k][a][i];
  }
  return shape;
}

TrueHits true_hits(const Ray& ray, const TriangleShape& triangle, Arithmetic arithmetic) {
  return decide(arithmetic, [&]<class N>() {
    TrueHits hits;
    const NumberRay<N> r(ray);
    const Vec<N> a = vec<N>(triangle.vertex[0]) - r.org, b = vec<N>(triangle.vertex[1]) - r.org, c = vec<N>(triangle.vertex[2]) - r.org;
    // Signed volumes of the direction with each edge: all on one side where the line passes through the closed triangle.
    const Vec<N> bc = cross(b, c);
    const N volume[3] = {dot(r.dir, bc), dot(r.dir, cross(c, a)), dot(r.dir, cross(a, b))};
    int positive = 0, negative = 0;
    for (const N& v : volume) {
      const int s = sign(v);
      positive += s > 0;
      negative += s < 0;
      if (positive > 0 && negative > 0) return hits;
    }
    if (positive + negative == 0) return hits;  // n . dir = 0 for the normal n
    const N slope = volume[0] + volume[1] + volume[2];
    const N height = dot(a, bc);
    if (r.contains(height, slope)) hits.add(sign(height) == 0 ? 0.0 : to_double(height) / to_double(slope));
    return hits;
  });
}

double distance(const TriangleShape& triangle, const Point& p) noexcept {
  const Point v[3] = {point(triangle.vertex[0]), point(triangle.vertex[1]), point(triangle.vertex[2])};
  const Point normal = cross_product(minus(v[1], v[0]), minus(v[2], v[0]));
  const double normal_length = length(normal);
  bool above = normal_length > 0;
  double nearest = segment_distance(v[2], v[0], p);
  for (std::size_t k = 0; k < 3; ++k) {
    const Point &a = v[k], &b = v[(k + 1) % 3];
    above = above && dot(cross_product(minus(b, a), minus(p, a)), normal) >= 0;
    nearest = std::min(nearest, segment_distance(a, b, p));
  }
  return above ? std::abs(dot(minus(p, v[0]), normal)) / normal_length : nearest;
}

}  // namespace raymeter::verify
