#include "core/bounds/prim_hull.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "core/geometry/error_bounds.h"

namespace raymeter {

namespace {

/// Room for the roundings of a few double operations, relative to the largest number in them.
constexpr double kRoundings = 0x1p-48;

double largest_coordinate(const glm::dvec3& p) noexcept { return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}); }

glm::dvec3 at(const FloatColumns3& columns, std::size_t i) noexcept { return {columns[0][i], columns[1][i], columns[2][i]}; }

void add_box(PrimHull& hull, const Aabb& box) noexcept {
  for (int corner = 0; corner < 8; ++corner) {
    hull.points[static_cast<std::size_t>(hull.point_count++)] =
        glm::dvec3(corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y, corner & 4 ? box.max.z : box.min.z);
  }
}

/// A unit vector across `normal`.
glm::dvec3 sideways(const glm::dvec3& normal) noexcept {
  const glm::dvec3 some = std::abs(normal.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  return glm::normalize(some - glm::dot(some, normal) * normal);
}

void add_rims(PrimHull& hull, const ConePool& cones, std::size_t i) noexcept {
  const glm::dvec3 axis = at(cones.axis, i), base = at(cones.base, i);
  const double length = glm::length(axis);
  const glm::dvec3 normal = length > 0 ? axis / length : glm::dvec3(0.0);
  hull.discs[0] = {base, normal, double{cones.radius[0][i]}};
  hull.discs[1] = {base + axis, normal, double{cones.radius[1][i]}};
  hull.disc_count = 2;
}

}  // namespace

double PrimHull::reach(const glm::dvec3& direction, const glm::dvec3& origin) const noexcept {
  double most = -std::numeric_limits<double>::infinity();
  const double length = glm::length(direction);
  for (int k = 0; k < point_count; ++k) most = std::max(most, glm::dot(direction, points[static_cast<std::size_t>(k)] - origin));
  for (int k = 0; k < disc_count; ++k) {
    const Disc& disc = discs[static_cast<std::size_t>(k)];
    const double across = glm::length(direction - glm::dot(direction, disc.normal) * disc.normal);
    most = std::max(most, glm::dot(direction, disc.center - origin) + disc.radius * across);
  }
  return most + length * (margin + kRoundings * largest_coordinate(origin));
}

double PrimHull::furthest(const glm::dvec3& from, glm::dvec3& furthest) const noexcept {
  double most = -1;
  glm::dvec3 away(0.0);
  const auto consider = [&](const glm::dvec3& offset, double distance) noexcept {
    if (distance <= most) return;
    most = distance;
    away = offset;
  };
  for (int k = 0; k < point_count; ++k) {
    const glm::dvec3 offset = points[static_cast<std::size_t>(k)] - from;
    consider(offset, glm::length(offset));
  }
  for (int k = 0; k < disc_count; ++k) {
    const Disc& disc = discs[static_cast<std::size_t>(k)];
    const glm::dvec3 to_center = disc.center - from;
    const glm::dvec3 height = glm::dot(to_center, disc.normal) * disc.normal, across = to_center - height;
    const double off_axis = glm::length(across);
    // Near the axis the way outwards is lost in rounding, and any will do.
    const glm::dvec3 outwards = off_axis > 1e-6 * disc.radius ? across / off_axis : sideways(disc.normal);
    consider(to_center + disc.radius * outwards, std::hypot(glm::length(height), off_axis + disc.radius));
  }
  const double grown = most + margin + kRoundings * largest_coordinate(from);
  furthest = most > 0 ? from + away * (grown / most) : from + glm::dvec3(grown, 0, 0);
  return grown;
}

PrimHull prim_hull(const Pools& pools, PrimRef prim) noexcept {
  PrimHull hull;
  const std::size_t i = prim.index;
  const Aabb box = tight_bounds(pools, prim);
  switch (prim.kind()) {
    case PrimKind::sphere:
      hull.points[0] = at(pools.spheres.center, i);
      hull.point_count = 1;
      hull.margin = double{pools.spheres.radius[i]};
      break;
    case PrimKind::triangle:
      for (std::size_t k = 0; k < 3; ++k) hull.points[k] = at(pools.triangles.vertex[k], i);
      hull.point_count = 3;
      break;
    case PrimKind::polygon: add_box(hull, box); break;
    case PrimKind::cone: add_rims(hull, pools.cones, i); break;
  }
  const glm::dvec3 low(box.min), high(box.max);
  const double coordinate = std::max(largest_coordinate(low), largest_coordinate(high));
  hull.margin += double{kSurfaceError} * glm::length(high - low) + kRoundings * coordinate;
  return hull;
}

double hull_half_area(const Pools& pools, PrimRef prim) noexcept {
  const std::size_t i = prim.index;
  glm::dvec3 twice_area(0.0);
  switch (prim.kind()) {
    case PrimKind::sphere: return 2 * std::numbers::pi * double{pools.spheres.radius[i]} * double{pools.spheres.radius[i]};
    case PrimKind::triangle: {
      const glm::dvec3 a = at(pools.triangles.vertex[0], i);
      return glm::length(glm::cross(at(pools.triangles.vertex[1], i) - a, at(pools.triangles.vertex[2], i) - a)) / 2;
    }
    case PrimKind::polygon: {
      const auto first = static_cast<std::size_t>(pools.polygons.first_vertex[i]), end = static_cast<std::size_t>(pools.polygons.first_vertex[i + 1]);
      const glm::dvec3 a = at(pools.polygons.vertex, first);
      for (std::size_t k = first + 2; k < end; ++k) twice_area += glm::cross(at(pools.polygons.vertex, k - 1) - a, at(pools.polygons.vertex, k) - a);
      return glm::length(twice_area) / 2;
    }
    case PrimKind::cone: {
      const double base = double{pools.cones.radius[0][i]}, apex = double{pools.cones.radius[1][i]};
      const double slant = std::hypot(glm::length(at(pools.cones.axis, i)), base - apex);
      return std::numbers::pi * ((base + apex) * slant + base * base + apex * apex) / 2;
    }
  }
  return 0;
}

}  // namespace raymeter
