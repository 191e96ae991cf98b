#include "core/bounds/kdop_polytope.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace raymeter {

namespace {

/// A parallelogram has 4 vertices, and each of the other slabs' two planes adds one at most.
constexpr std::size_t kMostVertices = 4 + 2 * (KdopLayout::kMaxSlabs - 3);

/// A convex polygon in a plane.
struct Polygon {
  std::array<double, kMostVertices> u, v;
  std::size_t count = 0;

  void add(double at_u, double at_v) noexcept {
    u[count] = at_u;
    v[count++] = at_v;
  }

  /// Keeps what has x u + y v <= limit. Goes both ways from the vertex furthest outside until back inside: that run is replaced by two crossings. A convex
  /// polygon has no other; where rounding makes one of an edge along the line, the vertices left are outside by no more than that.
  void cut(double x, double y, double limit) noexcept {
    std::array<double, kMostVertices> above;
    for (std::size_t k = 0; k < count; ++k) above[k] = x * u[k] + y * v[k] - limit;
    std::size_t furthest = 0;
    for (std::size_t k = 1; k < count; ++k) furthest = above[k] > above[furthest] ? k : furthest;
    if (!(above[furthest] > 0)) return;
    const auto next = [&](std::size_t k) { return k + 1 < count ? k + 1 : 0; };
    const auto previous = [&](std::size_t k) { return k > 0 ? k - 1 : count - 1; };
    std::size_t first = next(furthest), last = previous(furthest);  // inside
    while (above[first] > 0 && first != furthest) first = next(first);
    if (first == furthest) {
      count = 0;
      return;
    }
    while (above[last] > 0) last = previous(last);
    Polygon part;
    for (std::size_t k = first; k != last; k = next(k)) part.add(u[k], v[k]);
    part.add(u[last], v[last]);
    const auto add_crossing = [&](std::size_t in, std::size_t out) {
      const double share = above[in] / (above[in] - above[out]);
      part.add(u[in] + (u[out] - u[in]) * share, v[in] + (v[out] - v[in]) * share);
    };
    add_crossing(last, next(last));
    add_crossing(first, previous(first));
    count = part.count;
    std::copy_n(part.u.begin(), count, u.begin());
    std::copy_n(part.v.begin(), count, v.begin());
  }

  [[nodiscard]] double area() const noexcept {
    double sum = 0;
    for (std::size_t k = 2; k < count; ++k) sum += (u[k - 1] - u[0]) * (v[k] - v[0]) - (v[k - 1] - v[0]) * (u[k] - u[0]);
    return std::abs(sum) / 2;
  }
};

}  // namespace

KdopPolytope::KdopPolytope(std::span<const glm::vec3> directions) : directions_(directions.begin(), directions.end()) {
  glm::dmat3 basis(0.0);
  for (std::size_t i = 0; i < directions_.size(); ++i) {
    for (std::size_t j = i + 1; j < directions_.size(); ++j) {
      for (std::size_t k = j + 1; k < directions_.size(); ++k) {
        const glm::dmat3 rows = glm::transpose(glm::dmat3(directions_[i], directions_[j], directions_[k]));
        if (!(std::abs(glm::determinant(rows)) > std::abs(determinant_))) continue;
        determinant_ = glm::determinant(rows);
        basis = rows;
        basis_slabs_ = {i, j, k};
      }
    }
  }
  if (!spans_space()) return;
  from_basis_ = glm::inverse(basis);
  for (const glm::dvec3& normal : directions_) {
    const glm::dvec3 other = std::abs(normal.x) < std::abs(normal.y) ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 x = glm::normalize(glm::cross(normal, other)), y = glm::cross(glm::normalize(normal), x);
    for (const glm::dvec3& direction : directions_)
      traces_.push_back({glm::dot(direction, x), glm::dot(direction, y), glm::dot(direction, normal) / glm::dot(normal, normal)});
    planes_.push_back({.length = glm::length(normal)});
  }
  for (std::size_t i = 0; i < planes_.size(); ++i) choose_edges(i);
}

bool KdopPolytope::spans_space() const noexcept { return std::abs(determinant_) > 1e-3; }

void KdopPolytope::choose_edges(std::size_t face) {
  double most = 0;
  for (std::size_t i = 0; i < planes_.size(); ++i) {
    for (std::size_t j = i + 1; j < planes_.size(); ++j) {
      const Trace &a = trace(face, i), &b = trace(face, j);
      const double determinant = a.x * b.y - a.y * b.x;
      if (i == face || j == face || !(std::abs(determinant) > std::abs(most))) continue;
      most = determinant;
      planes_[face].edge_slabs = {i, j};
      planes_[face].to_point = {b.y / determinant, -a.y / determinant, -b.x / determinant, a.x / determinant};
    }
  }
}

double KdopPolytope::face_area(std::size_t face, double height, const Limits& low, const Limits& high) const noexcept {
  const Plane& plane = planes_[face];
  const auto& edges = plane.edge_slabs;
  std::array<double, 2> near, far;
  for (std::size_t e = 0; e < 2; ++e) {
    const double shift = trace(face, edges[e]).along * height;
    near[e] = low[edges[e]] - shift;
    far[e] = high[edges[e]] - shift;
  }
  Polygon polygon;
  const auto add_corner = [&polygon, &to = plane.to_point](double a, double b) { polygon.add(to[0] * a + to[1] * b, to[2] * a + to[3] * b); };
  add_corner(near[0], near[1]);
  add_corner(far[0], near[1]);
  add_corner(far[0], far[1]);
  add_corner(near[0], far[1]);
  for (std::size_t i = 0; i < planes_.size() && polygon.count > 0; ++i) {
    if (i == face || i == edges[0] || i == edges[1]) continue;
    const Trace& slab = trace(face, i);
    const double shift = slab.along * height;
    polygon.cut(slab.x, slab.y, high[i] - shift);
    polygon.cut(-slab.x, -slab.y, shift - low[i]);
  }
  return polygon.area();
}

KdopPolytope::Measure KdopPolytope::measure(std::span<const float> min, std::span<const float> max) const noexcept {
  Measure polytope;
  if (!spans_space()) return polytope;
  // From the middle of the parallelepiped of three slabs, so that far from the origin nothing cancels.
  glm::dvec3 middle;
  for (glm::length_t a = 0; a < 3; ++a) {
    const std::size_t slab = basis_slabs_[static_cast<std::size_t>(a)];
    middle[a] = (double{max[slab]} + double{min[slab]}) / 2;
  }
  const glm::dvec3 center = from_basis_ * middle;
  Limits low{}, high{};
  for (std::size_t i = 0; i < planes_.size(); ++i) {
    const double shift = glm::dot(directions_[i], center);
    low[i] = double{min[i]} - shift;
    high[i] = double{max[i]} - shift;
  }
  for (std::size_t i = 0; i < planes_.size(); ++i) {
    const double top = face_area(i, high[i], low, high), bottom = face_area(i, low[i], low, high);
    polytope.area += top + bottom;
    polytope.enclosed += (top * high[i] - bottom * low[i]) / planes_[i].length / 3;  // pyramids from the middle; outside of it heights are negative
  }
  return polytope;
}

}  // namespace raymeter
