#include "experiments/verify/polygon_truth.h"

#include <algorithm>
#include <limits>
#include <optional>

namespace raymeter::verify {

namespace {

/// Whether the line passes through the outline; exact.
template <class N>
bool passes_through(const NumberRay<N>& ray, const PolygonShape& polygon) {
  std::size_t major = 0;
  while (sign(ray.dir[major]) == 0) ++major;
  const std::size_t p = (major + 1) % 3, q = (major + 2) % 3;
  struct Seen {
    N x, y;
  };
  const auto see = [&](const std::array<float, 3>& vertex) {
    const float position[3] = {vertex[0], vertex[1], vertex[2]};
    const Vec<N> to = vec<N>(position) - ray.org;
    return Seen{N(to[p] * ray.dir[major] - to[major] * ray.dir[p]), N(to[q] * ray.dir[major] - to[major] * ray.dir[q])};
  };
  bool odd = false, on_outline = false, edge_on = true;
  Seen a = see(polygon.vertex.back());
  for (const auto& vertex : polygon.vertex) {
    Seen b = see(vertex);
    const int side = sign(N(a.x * b.y - a.y * b.x));
    edge_on = edge_on && side == 0;
    const int ay = sign(a.y), by = sign(b.y);
    if ((ay <= 0) != (by <= 0) && side == (by > 0 ? 1 : -1)) odd = !odd;
    if (side == 0 && ay * by <= 0 && sign(a.x) * sign(b.x) <= 0) on_outline = true;
    a = std::move(b);
  }
  return !edge_on && (odd || on_outline);
}

/// t of the plane, moved into the bounding box where it is outside; empty where the line is parallel to the plane: then the box alone decides.
template <class N>
N plane_in_box(const NumberRay<N>& ray, const PolygonShape& polygon) {
  const float first[3] = {polygon.vertex[0][0], polygon.vertex[0][1], polygon.vertex[0][2]};
  const Vec<N> normal = vec<N>(polygon.normal);
  const N slope = dot(normal, ray.dir), height = dot(normal, vec<N>(first) - ray.org);
  std::optional<N> near, far;
  for (std::size_t a = 0; a < 3; ++a) {
    if (sign(ray.dir[a]) == 0) continue;
    const auto [low, high] = std::minmax_element(polygon.vertex.begin(), polygon.vertex.end(), [a](const auto& v, const auto& w) { return v[a] < w[a]; });
    const N t0 = (N(double{(*low)[a]}) - ray.org[a]) / ray.dir[a], t1 = (N(double{(*high)[a]}) - ray.org[a]) / ray.dir[a];
    const N enter = smaller(t0, t1), leave = larger(t0, t1);
    near = near ? larger(*near, enter) : enter;
    far = far ? smaller(*far, leave) : leave;
  }
  if (sign(slope) == 0) return *near;
  return smaller(larger(N(height / slope), *near), *far);
}

}  // namespace

PolygonShape polygon_at(const Pools& pools, std::size_t i) {
  const PolygonPool& pool = pools.polygons;
  PolygonShape shape{{}, {pool.normal[0][i], pool.normal[1][i], pool.normal[2][i]}};
  for (auto k = static_cast<std::size_t>(pool.first_vertex[i]); k < static_cast<std::size_t>(pool.first_vertex[i + 1]); ++k) {
    shape.vertex.push_back({pool.vertex[0][k], pool.vertex[1][k], pool.vertex[2][k]});
  }
  return shape;
}

TrueHits true_hits(const Ray& ray, const PolygonShape& polygon, Arithmetic arithmetic) {
  return decide(arithmetic, [&]<class N>() {
    TrueHits hits;
    const NumberRay<N> r(ray);
    if (!passes_through(r, polygon)) return hits;
    const N t = plane_in_box(r, polygon);
    if (r.contains(t, N(1.0))) hits.add(sign(t) == 0 ? 0.0 : to_double(t));
    return hits;
  });
}

namespace {

/// Where the line is inside the bounding box; beside it, between the ends that fail to meet.
std::array<double, 2> in_box(const PolygonShape& polygon, const Point& org, const Point& dir) noexcept {
  double near = -std::numeric_limits<double>::infinity(), far = -near;
  for (std::size_t a = 0; a < 3; ++a) {
    if (dir[a] == 0) continue;
    const auto [low, high] = std::minmax_element(polygon.vertex.begin(), polygon.vertex.end(), [a](const auto& v, const auto& w) { return v[a] < w[a]; });
    const double t0 = (double{(*low)[a]} - org[a]) / dir[a], t1 = (double{(*high)[a]} - org[a]) / dir[a];
    near = std::max(near, std::min(t0, t1));
    far = std::min(far, std::max(t0, t1));
  }
  return near <= far ? std::array{near, far} : std::array{far, near};
}

/// Distance of org from the plane along the normal, and its change per unit of t.
std::array<double, 2> from_plane(const PolygonShape& polygon, const Point& org, const Point& dir) noexcept {
  const auto& first = polygon.vertex[0];
  const Point normal = point(polygon.normal);
  const double normal_length = length(normal);
  if (normal_length == 0) return {0, 0};
  return {dot(normal, minus({double{first[0]}, double{first[1]}, double{first[2]}}, org)) / normal_length, dot(normal, dir) / normal_length};
}

}  // namespace

double depth(const PolygonShape& polygon, const Point& org, const Point& dir) noexcept {
  const auto [near, far] = in_box(polygon, org, dir);
  const auto [height, slope] = from_plane(polygon, org, dir);
  return slope != 0 ? std::clamp(height / slope, near, far) : near;
}

double distance(const PolygonShape& polygon, const Point& org, const Point& dir, double t) noexcept {
  const auto [near, far] = in_box(polygon, org, dir);
  const auto [height, slope] = from_plane(polygon, org, dir);
  const double meant = slope != 0 ? height / slope : near;
  // Where the plane is cut off, all that matters is not to be further inside than the cut.
  const double off = meant < near ? std::max(t - near, 0.0) : meant > far ? std::max(far - t, 0.0) : std::abs(t - meant);
  const Point p = along(org, t, dir);
  double outside2 = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto [low, high] = std::minmax_element(polygon.vertex.begin(), polygon.vertex.end(), [a](const auto& v, const auto& w) { return v[a] < w[a]; });
    outside2 += std::pow(std::max({double{(*low)[a]} - p[a], p[a] - double{(*high)[a]}, 0.0}), 2);
  }
  return std::max(std::min(std::abs(height - slope * t), off * length(dir)), std::sqrt(outside2));
}

}  // namespace raymeter::verify
