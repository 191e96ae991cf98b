#include "core/scene/surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

namespace raymeter {

namespace {

using glm::dvec3;

dvec3 at(const FloatColumns3& columns, std::size_t i) noexcept { return {double{columns[0][i]}, double{columns[1][i]}, double{columns[2][i]}}; }

dvec3 unit_or(const dvec3& v, const dvec3& otherwise) noexcept {
  const double length = glm::length(v);
  return length > 0 ? v / length : otherwise;
}

/// The root of a s^2 + 2 b s + c = 0 that is nearer to 0; of a pair that rounding made complex, the point between.
double smaller_root(double a, double b, double c) noexcept {
  const double q = -(b + std::copysign(std::sqrt(std::max(0.0, b * b - a * c)), b));
  return q != 0 ? c / q : 0;
}

struct Line {
  dvec3 near;  ///< the point that the kernel found
  dvec3 dir;
  double distance;  ///< of that point from the ray's origin
};

/// What rounding a point's coordinates moves it along the normal at most, in unit roundoffs.
double rounding(const dvec3& point, const dvec3& normal) noexcept {
  return std::abs(normal.x * point.x) + std::abs(normal.y * point.y) + std::abs(normal.z * point.z);
}

Surface finished(const dvec3& point, const dvec3& normal, double diameter, const Line& line) noexcept {
  return {point, normal, normal, double{kLeavingError} * diameter + double{kUnitRoundoff} * (16 * line.distance + 2 * rounding(point, normal))};
}

Surface on_sphere(const SpherePool& pool, std::size_t i, const Line& line) noexcept {
  const dvec3 center = at(pool.center, i);
  const double radius = double{pool.radius[i]};
  const dvec3 f = line.near - center;
  const double s = smaller_root(glm::dot(line.dir, line.dir), glm::dot(f, line.dir), glm::dot(f, f) - radius * radius);
  const dvec3 normal = unit_or(f + s * line.dir, -glm::normalize(line.dir));
  return finished(center + radius * normal, normal, 2 * radius, line);
}

Surface on_cone(const ConePool& pool, std::size_t i, const Line& line) noexcept {
  const dvec3 base = at(pool.base, i), axis = at(pool.axis, i);
  const double base_radius = double{pool.radius[0][i]}, apex_radius = double{pool.radius[1][i]};
  const double taper = apex_radius - base_radius;
  const double axis2 = glm::dot(axis, axis);
  const dvec3 f = line.near - base;
  const double height = glm::dot(f, axis) / axis2, climb = glm::dot(line.dir, axis) / axis2;
  const dvec3 w = f - height * axis, v = line.dir - climb * axis;
  const double radius = base_radius + taper * height, narrowing = taper * climb;
  const double s = smaller_root(glm::dot(v, v) - narrowing * narrowing, glm::dot(w, v) - narrowing * radius, glm::dot(w, w) - radius * radius);
  const double height_there = std::clamp(height + s * climb, 0.0, 1.0);  // beyond an apex its mirror image would begin, whose normals point inwards
  const dvec3 off_axis = w + s * v;                                      // at an apex nothing but roundings, of any direction
  const dvec3 outwards = unit_or(off_axis - glm::dot(off_axis, axis) / axis2 * axis, -unit_or(v, dvec3(0.0)));
  // The radius changes by taper over the axis' length: that much the normal leans towards the narrow end.
  const dvec3 normal = unit_or(outwards - taper / axis2 * axis, outwards);
  const dvec3 point = base + height_there * axis + (base_radius + taper * height_there) * outwards;
  return finished(point, normal, std::sqrt(axis2) + 2 * std::max(base_radius, apex_radius), line);
}

/// Where the line meets the plane; where that is beyond the primitive, whose plane the line all but lies in, the found point's foot.
Surface on_plane(const dvec3& origin, const dvec3& plane_normal, double diameter, const Line& line) noexcept {
  const dvec3 normal = unit_or(plane_normal, -glm::normalize(line.dir));
  const double below = glm::dot(normal, origin - line.near);
  const double slope = glm::dot(normal, line.dir);
  const bool on_line = std::abs(below) * glm::length(line.dir) < std::abs(slope) * diameter;
  return finished(line.near + (on_line ? below / slope * line.dir : below * normal), normal, diameter, line);
}

Surface on_triangle(const TrianglePool& pool, std::size_t i, const Line& line) noexcept {
  const dvec3 a = at(pool.vertex[0], i);
  const dvec3 ab = at(pool.vertex[1], i) - a, ac = at(pool.vertex[2], i) - a;
  const dvec3 cross = glm::cross(ab, ac);
  Surface surface = on_plane(a, cross, std::max({glm::length(ab), glm::length(ac), glm::length(ac - ab)}), line);
  if (pool.normal_index.empty() || pool.normal_index[i] < 0) return surface;
  const dvec3 ap = surface.point - a;
  const double area2 = glm::dot(cross, cross);
  const double u = glm::dot(glm::cross(ap, ac), cross) / area2, v = glm::dot(glm::cross(ab, ap), cross) / area2;
  const auto k = static_cast<std::size_t>(pool.normal_index[i]);
  surface.shading = unit_or((1 - u - v) * at(pool.normal[0], k) + u * at(pool.normal[1], k) + v * at(pool.normal[2], k), surface.geometric);
  return surface;
}

Surface on_polygon(const PolygonPool& pool, std::size_t i, const Line& line) noexcept {
  const double diagonal = glm::length(at(pool.box_max, i) - at(pool.box_min, i));
  Surface surface = on_plane(at(pool.vertex, static_cast<std::size_t>(pool.first_vertex[i])), at(pool.normal, i), diagonal, line);
  surface.clearance += 2 * double{kUnitRoundoff} * rounding(surface.point, surface.geometric);  // vertices that are rounded lie in no plane
  return surface;
}

}  // namespace

Surface surface_at(const Scene& scene, const Ray& ray, float t, std::int32_t prim) noexcept {
  const dvec3 org(ray.org[0], ray.org[1], ray.org[2]), dir(ray.dir[0], ray.dir[1], ray.dir[2]);
  const Line line{org + double{t} * dir, dir, double{t} * glm::length(dir)};
  const PrimRef ref = scene.prim(prim);
  const std::size_t i = ref.index;
  switch (ref.kind()) {
    case PrimKind::sphere: return on_sphere(scene.pools().spheres, i, line);
    case PrimKind::triangle: return on_triangle(scene.pools().triangles, i, line);
    case PrimKind::polygon: return on_polygon(scene.pools().polygons, i, line);
    case PrimKind::cone: return on_cone(scene.pools().cones, i, line);
  }
  return {};
}

namespace {

Ray lifted_ray(const Surface& surface, const dvec3& towards) noexcept {
  const double lift = glm::dot(surface.geometric, towards) < 0 ? -surface.clearance : surface.clearance;
  const glm::vec3 org(surface.point + lift * surface.geometric);
  return {{org.x, org.y, org.z}, 0, {0, 0, 0}, std::numeric_limits<float>::infinity()};
}

void set_direction(Ray& ray, const dvec3& dir, double distance_min) noexcept {
  for (int a = 0; a < 3; ++a) ray.dir[a] = static_cast<float>(dir[a]);
  if (distance_min > 0) ray.t_min = static_cast<float>(distance_min / glm::length(dir));
}

}  // namespace

Ray spawn_ray(const Surface& surface, const dvec3& dir, double distance_min) noexcept {
  Ray ray = lifted_ray(surface, dir);
  set_direction(ray, dir, distance_min);
  return ray;
}

Ray spawn_ray_to(const Surface& surface, const dvec3& target, double distance_min) noexcept {
  return spawn_ray_to(surface, LightTarget{target, {}}, distance_min);
}

Ray spawn_ray_to(const Surface& surface, const LightTarget& light, double distance_min) noexcept {
  const dvec3 towards = light.light - surface.point;
  Ray ray = lifted_ray(surface, towards);
  const dvec3 org(ray.org[0], ray.org[1], ray.org[2]);
  // An end that is lower than the origin, as of a light in the surface's own plane, is passed above: a ray that sinks comes to where the kernel errs.
  const dvec3 up = glm::dot(surface.geometric, towards) < 0 ? -surface.geometric : surface.geometric;
  set_direction(ray, light.seen_from(org, {up, glm::dot(up, towards), surface.clearance}) - org, distance_min);
  ray.t_max = 1 - kUnitRoundoff;
  return ray;
}

}  // namespace raymeter
