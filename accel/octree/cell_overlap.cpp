#include "accel/octree/cell_overlap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

namespace raymeter {

namespace {

/// Room for the roundings of a few dozen double operations, relative to the largest number in them.
constexpr double kRoundings = 0x1p-44;

double largest(const glm::dvec3& p) noexcept { return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}); }
glm::dvec3 at(const FloatColumns3& columns, std::size_t i) noexcept { return {columns[0][i], columns[1][i], columns[2][i]}; }

/// How far a box reaches from its centre along `axis`.
double reach(const glm::dvec3& half, const glm::dvec3& axis) noexcept {
  return half.x * std::abs(axis.x) + half.y * std::abs(axis.y) + half.z * std::abs(axis.z);
}

/// Separating axes (Akenine-Moeller 2001) but for the box's own, which the boxes have been tested for.
bool triangle_touches(const std::array<glm::dvec3, 3>& corner, const glm::dvec3& half) noexcept {
  const double size = largest(half) + std::max({largest(corner[0]), largest(corner[1]), largest(corner[2])});
  const auto separates = [&](const glm::dvec3& axis) noexcept {
    const double p[3] = {glm::dot(corner[0], axis), glm::dot(corner[1], axis), glm::dot(corner[2], axis)};
    const double r = reach(half, axis) + kRoundings * size * largest(axis);
    return std::min({p[0], p[1], p[2]}) > r || std::max({p[0], p[1], p[2]}) < -r;
  };
  const glm::dvec3 edge[3] = {corner[1] - corner[0], corner[2] - corner[1], corner[0] - corner[2]};
  // The normal's own rounding is relative to the product of the edges, which may be far larger than itself.
  const glm::dvec3 normal = glm::cross(edge[0], edge[1]);
  const double r = reach(half, normal) + kRoundings * size * largest(edge[0]) * largest(edge[1]);
  if (std::abs(glm::dot(normal, corner[0])) > r) return false;
  for (const glm::dvec3& e : edge) {
    if (separates({0, e.z, -e.y}) || separates({-e.z, 0, e.x}) || separates({e.y, -e.x, 0})) return false;
  }
  return true;
}

bool sphere_touches(const glm::dvec3& to_center, double radius, const glm::dvec3& half) noexcept {
  const glm::dvec3 off = glm::abs(to_center);
  const double slack = kRoundings * (largest(off) + largest(half) + radius);
  return glm::length(glm::max(off - half, glm::dvec3(0.0))) <= radius + slack && glm::length(off + half) >= radius - slack;
}

/// The slab between the planes that hold all vertices: 'the' plane of a polygon that is not quite flat.
bool polygon_touches(const PolygonPool& polygons, std::size_t i, const glm::dvec3& center, const glm::dvec3& half) noexcept {
  const glm::dvec3 normal = at(polygons.normal, i);
  double low = std::numeric_limits<double>::infinity(), high = -low, size = largest(half);
  for (auto k = static_cast<std::size_t>(polygons.first_vertex[i]); k < static_cast<std::size_t>(polygons.first_vertex[i + 1]); ++k) {
    const glm::dvec3 vertex = at(polygons.vertex, k) - center;
    low = std::min(low, glm::dot(normal, vertex));
    high = std::max(high, glm::dot(normal, vertex));
    size = std::max(size, largest(vertex));
  }
  const double r = reach(half, normal) + kRoundings * size * largest(normal);
  return low <= r && high >= -r;
}

/// A cone relative to the box's centre: discs of radius r[0] around base and r[1] around base + length * axis.
struct Cone {
  glm::dvec3 base;
  glm::dvec3 axis;  ///< unit
  double length;
  double r[2];

  /// Least value of w . x over its convex hull.
  [[nodiscard]] double least(const glm::dvec3& w) const noexcept {
    const double along = glm::dot(w, axis);
    const double across = glm::length(w - along * axis), start = glm::dot(w, base);
    return std::min(start - r[0] * across, start + along * length - r[1] * across);
  }
  /// Whether the point is inside by more than `slack`, and so away from the surface by that.
  [[nodiscard]] bool holds(const glm::dvec3& point, double slack) const noexcept {
    const glm::dvec3 from = point - base;
    const double height = glm::dot(from, axis);
    const double slope = (r[1] - r[0]) / length;
    const double off_axis = glm::length(from - height * axis);
    return height > slack && height < length - slack && (r[0] + slope * height - off_axis) > slack * std::sqrt(1 + slope * slope);
  }
};

bool cone_touches(const ConePool& cones, std::size_t i, const glm::dvec3& center, const glm::dvec3& half) noexcept {
  const glm::dvec3 axis = at(cones.axis, i);
  Cone cone{at(cones.base, i) - center, axis, glm::length(axis), {double{cones.radius[0][i]}, double{cones.radius[1][i]}}};
  const double size = largest(cone.base) + cone.length + std::max(cone.r[0], cone.r[1]) + largest(half);
  const double slack = kRoundings * size;
  if (!(cone.length > slack)) return true;
  cone.axis = axis / cone.length;
  const auto separates = [&](const glm::dvec3& w) noexcept { return cone.least(w) > reach(half, w) + slack; };  // w of length 1 at most
  if (separates(cone.axis) || separates(-cone.axis)) return false;
  // From the box outwards to the axis, and the same tilted by the slope of the surface.
  const glm::dvec3 across = cone.base - glm::dot(cone.base, cone.axis) * cone.axis;
  if (const double distance = glm::length(across); distance > slack) {
    const glm::dvec3 outwards = across / distance;
    const double taper = cone.r[1] - cone.r[0];
    const glm::dvec3 tilted = (cone.length * outwards + taper * cone.axis) / std::hypot(cone.length, taper);
    if (separates(outwards) || separates(tilted)) return false;
  }
  for (int c = 0; c < 8; ++c) {
    if (!cone.holds({c & 1 ? half.x : -half.x, c & 2 ? half.y : -half.y, c & 4 ? half.z : -half.z}, slack)) return true;
  }
  return false;  // the cone is convex: with its corners the whole box is inside
}

}  // namespace

bool may_touch(const Pools& pools, PrimRef prim, const glm::dvec3& center, const glm::dvec3& half) noexcept {
  const std::size_t i = prim.index;
  switch (prim.kind()) {
    case PrimKind::triangle:
      return triangle_touches({at(pools.triangles.vertex[0], i) - center, at(pools.triangles.vertex[1], i) - center, at(pools.triangles.vertex[2], i) - center},
                              half);
    case PrimKind::sphere: return sphere_touches(at(pools.spheres.center, i) - center, double{pools.spheres.radius[i]}, half);
    case PrimKind::polygon: return polygon_touches(pools.polygons, i, center, half);
    case PrimKind::cone: return cone_touches(pools.cones, i, center, half);
  }
  return true;
}

}  // namespace raymeter
