#include "accel/bvh/surface_measure.h"

#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace raymeter {

namespace {

using glm::dvec3;

dvec3 at(const FloatColumns3& columns, std::size_t i) noexcept { return {double{columns[0][i]}, double{columns[1][i]}, double{columns[2][i]}}; }

/// Twice the area, as a vector.
dvec3 area_vector(const std::vector<dvec3>& outline) noexcept {
  dvec3 sum(0.0);
  for (std::size_t i = 2; i < outline.size(); ++i) sum += glm::cross(outline[i - 1] - outline[0], outline[i] - outline[0]);
  return sum;
}

/// The part of an outline where sign * (x_axis - position) <= 0. A concave outline may come back with edges that run to and fro on the plane: they enclose
/// nothing.
void clip(std::vector<dvec3>& outline, glm::length_t axis, double position, double sign) {
  std::vector<dvec3> inside;
  inside.reserve(outline.size() + 2);
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const dvec3 &a = outline[i], &b = outline[(i + 1) % outline.size()];
    const double height_a = sign * (a[axis] - position), height_b = sign * (b[axis] - position);
    if (height_a <= 0) inside.push_back(a);
    if ((height_a < 0 && height_b > 0) || (height_a > 0 && height_b < 0)) inside.push_back(a + height_a / (height_a - height_b) * (b - a));
  }
  outline = std::move(inside);
}

dvec3 any_perpendicular(const dvec3& v) noexcept { return std::abs(v.x) < std::abs(v.y) ? glm::cross(v, dvec3(1, 0, 0)) : glm::cross(v, dvec3(0, 1, 0)); }

}  // namespace

double surface_area(const Pools& pools, PrimRef ref) noexcept {
  const std::size_t i = ref.index;
  if (ref.kind() == PrimKind::sphere) {
    const double radius = double{pools.spheres.radius[i]};
    return 4 * std::numbers::pi * radius * radius;
  }
  if (ref.kind() == PrimKind::cone) {
    const double base = double{pools.cones.radius[0][i]}, apex = double{pools.cones.radius[1][i]};
    return std::numbers::pi * (base + apex) * std::hypot(glm::length(at(pools.cones.axis, i)), base - apex);
  }
  return 0.5 * glm::length(area_vector(outline(pools, ref)));
}

std::vector<dvec3> outline(const Pools& pools, PrimRef ref) {
  std::vector<dvec3> vertices;
  if (ref.kind() == PrimKind::triangle) {
    for (const FloatColumns3& vertex : pools.triangles.vertex) vertices.push_back(at(vertex, ref.index));
  } else {
    const auto begin = static_cast<std::size_t>(pools.polygons.first_vertex[ref.index]),
               end = static_cast<std::size_t>(pools.polygons.first_vertex[ref.index + 1]);
    for (std::size_t k = begin; k < end; ++k) vertices.push_back(at(pools.polygons.vertex, k));
  }
  return vertices;
}

double area_in_box(const std::vector<dvec3>& outline, const Aabb& box) {
  std::vector<dvec3> part = outline;
  for (glm::length_t a = 0; a < 3 && part.size() > 2; ++a) {
    clip(part, a, double{box.min[a]}, -1);
    clip(part, a, double{box.max[a]}, 1);
  }
  return part.size() > 2 ? 0.5 * glm::length(area_vector(part)) : 0;
}

dvec3 point_on_surface(const Pools& pools, PrimRef ref, double u, double v) noexcept {
  const std::size_t i = ref.index;
  const double angle = 2 * std::numbers::pi * u;
  if (ref.kind() == PrimKind::sphere) {
    const double z = 2 * v - 1, across = std::sqrt(1 - z * z);
    return at(pools.spheres.center, i) + double{pools.spheres.radius[i]} * dvec3(across * std::cos(angle), across * std::sin(angle), z);
  }
  if (ref.kind() == PrimKind::cone) {
    const dvec3 axis = at(pools.cones.axis, i);
    const double base = double{pools.cones.radius[0][i]}, apex = double{pools.cones.radius[1][i]};
    // The circumference grows linearly along the axis: the height that has a share v of the area below it.
    const double radius = std::sqrt(base * base + v * (apex * apex - base * base));
    const double height = apex != base ? (radius - base) / (apex - base) : v;
    const dvec3 x = glm::normalize(any_perpendicular(axis)), y = glm::normalize(glm::cross(axis, x));
    return at(pools.cones.base, i) + height * axis + radius * (std::cos(angle) * x + std::sin(angle) * y);
  }
  const std::vector<dvec3> vertices = outline(pools, ref);
  const double root = std::sqrt(u);
  return vertices[0] + root * (1 - v) * (vertices[1] - vertices[0]) + root * v * (vertices[2] - vertices[0]);
}

}  // namespace raymeter
