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

/// A triangle against boxes, by separating axes (Akenine-Moeller 2001) but for the boxes' own, which have been tested.
class TriangleOverlap {
public:
  explicit TriangleOverlap(const std::array<glm::dvec3, 3>& corner) noexcept
      : corner_(corner), edge_{corner[1] - corner[0], corner[2] - corner[1], corner[0] - corner[2]}, normal_(glm::cross(edge_[0], edge_[1])) {}

  [[nodiscard]] bool touches(const CellBox& box) const noexcept {
    const std::array<glm::dvec3, 3> corner{corner_[0] - box.center, corner_[1] - box.center, corner_[2] - box.center};
    const double rounding = kRoundings * (largest(box.half) + std::max({largest(corner[0]), largest(corner[1]), largest(corner[2])}));
    // The normal's own rounding is relative to the product of the edges, which may be far larger than itself.
    const double r = reach(box.half, normal_) + rounding * largest(edge_[0]) * largest(edge_[1]);
    if (std::abs(glm::dot(normal_, corner[0])) > r) return false;
    // Across an edge its two corners are in one place.
    return !separated(edge_[0], corner[0], corner[2], box.half, rounding) && !separated(edge_[1], corner[1], corner[0], box.half, rounding) &&
           !separated(edge_[2], corner[2], corner[1], box.half, rounding);
  }

private:
  /// By one of the axes across edge e and an axis of the box; `on` is a corner on the edge, `off` the one that is not.
  static bool separated(const glm::dvec3& e, const glm::dvec3& on, const glm::dvec3& off, const glm::dvec3& half, double rounding) noexcept {
    bool apart = false;
    for (glm::length_t a = 0; a < 3; ++a) {
      const glm::length_t b = a == 2 ? 0 : a + 1, c = a == 0 ? 2 : a - 1;
      const double p = on[b] * e[c] - on[c] * e[b], q = off[b] * e[c] - off[c] * e[b];
      const double eb = std::abs(e[b]), ec = std::abs(e[c]);
      const double r = half[b] * ec + half[c] * eb + rounding * std::max(eb, ec);
      apart |= (p > r && q > r) || (p < -r && q < -r);
    }
    return apart;
  }

  std::array<glm::dvec3, 3> corner_, edge_;
  glm::dvec3 normal_;
};

TriangleOverlap triangle_overlap(const TrianglePool& triangles, std::size_t i) noexcept {
  return TriangleOverlap({at(triangles.vertex[0], i), at(triangles.vertex[1], i), at(triangles.vertex[2], i)});
}

/// The children that hold corners of a triangle.
std::uint8_t with_corners(const TrianglePool& triangles, std::size_t i, const DividedCell& cell) noexcept {
  unsigned mask = 0;
  for (const FloatColumns3& vertex : triangles.vertex) {
    unsigned inside = 1, child = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const auto axis = static_cast<glm::length_t>(a);
      const float x = vertex[a][i];
      inside &= static_cast<unsigned>(x >= cell.box.min[axis]) & static_cast<unsigned>(x <= cell.box.max[axis]);
      child |= static_cast<unsigned>(x >= cell.split[axis]) << a;
    }
    mask |= inside << child;
  }
  return static_cast<std::uint8_t>(mask);
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
    case PrimKind::triangle: return triangle_overlap(pools.triangles, i).touches({center, half});
    case PrimKind::sphere: return sphere_touches(at(pools.spheres.center, i) - center, double{pools.spheres.radius[i]}, half);
    case PrimKind::polygon: return polygon_touches(pools.polygons, i, center, half);
    case PrimKind::cone: return cone_touches(pools.cones, i, center, half);
  }
  return true;
}

std::uint8_t touched(const Pools& pools, PrimRef prim, const DividedCell& cell, std::uint8_t of) noexcept {
  std::uint8_t mask = 0;
  const auto collect = [&](std::uint8_t unknown, auto&& touches) {
    for (unsigned left = unknown; left != 0; left &= left - 1) {
      const auto child = static_cast<std::size_t>(__builtin_ctz(left));
      if (touches(cell.child[child])) mask |= static_cast<std::uint8_t>(1u << child);
    }
  };
  if (prim.kind() == PrimKind::triangle) {
    mask = with_corners(pools.triangles, prim.index, cell) & of;
    if (mask == of) return mask;
    const TriangleOverlap triangle = triangle_overlap(pools.triangles, prim.index);
    collect(of & static_cast<std::uint8_t>(~mask), [&](const CellBox& box) { return triangle.touches(box); });
  } else {
    collect(of, [&](const CellBox& box) { return may_touch(pools, prim, box.center, box.half); });
  }
  return mask;
}

}  // namespace raymeter
