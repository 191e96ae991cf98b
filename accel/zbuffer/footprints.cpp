// Why a footprint loses no hit. u = kUnitRoundoff, S = ImagePlane::scale, q = (|V| / V_z)^2 of a vertex V seen from the eye: at least 1, and on the image plane
// whatever moves across a ray by e |V| moves by e q S half samples at the most (to first order; q is limited, and the second is far below the slack).
//
// Triangles and polygons: their kernels decide exactly, but on vertices that are off by kSeenVertexError |V| across the ray, and the ray's direction is off by
// a rounding from its sample: seen from the true sample, the vertices lie within epsilon = 16 u q S of where they are projected to. The kernels accept samples
// in the hull of the vertices as they see them, alone. The same weights give a point of the hull of the projected vertices within epsilon of the sample: edges
// and bounds that are moved outwards by epsilon keep it. This asks for no orientation, only that the edges' is that of the projected triangle, so slivers whose
// area may be a rounding have bounds alone. What an edge function loses in float is at most 8 u (|a| + |b|) times the largest coordinate.
// Spheres and cones: a hit lies within kSurfaceError (|P - org| + size) of the surface. So the ray meets the sphere grown by that, or the hull of the two
// spheres around a cone's ends, and their silhouettes bound the samples.
//
// Depth: P is outside the primitive's box by no more than kPrimitiveError (|P - org| + extent) on each axis; across the axes that is 16 u (1 + 2 sqrt(3)) times
// the farthest corner, since no extent exceeds twice that; a triangle's t is within 28 u times its farthest vertex of the depth of a point of it. Both are less
// than 96 u times the farthest corner, with what comparing depths loses.
//
// The plane of a triangle's depth: 1 / depth at a sample is a mean, by those weights, of the vertices' as the kernel sees them, 16 * 10 u off at the most; so
// it is that of the projected triangle's plane within epsilon of the sample, and t adds the 28 u. A polygon's t is that of the plane through its vertex 0 with
// its stored normal n: with height h = n . (vertex - org) off by 4 u |n| |vertex - org| and slope by 4 u |n| |dir|; or, clamped, that of its box, in which the
// ray passes a point of the hull, as far off the plane as the vertices are, at the most.
//
// A primitive that reaches behind the eye, or to where q grows beyond kMaxObliquity, may be anywhere: it covers the whole image from depth 0 on, unless all of
// it is behind: eye rays run forwards.

#include "accel/zbuffer/footprints.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include <glm/geometric.hpp>

#include "accel/zbuffer/outline.h"

namespace raymeter {

namespace {

using glm::dvec2;
using glm::dvec3;

/// Square of |V| / V_z of what is projected, at the most.
constexpr double kMaxObliquity = 256;

dvec3 point(const FloatColumns3& columns, std::size_t i) noexcept { return {columns[0][i], columns[1][i], columns[2][i]}; }

/// Vertices on the image.
class Vertices {
public:
  explicit Vertices(const ImagePlane& plane) noexcept : plane_(plane) {}

  /// Where a vertex is seen. Returns false where it is not before the eye, or too far beside it.
  bool add(const dvec3& vertex, dvec2& seen) noexcept {
    const dvec3 from_eye = vertex - plane_.eye;
    const dvec3 v = plane_.to_camera(from_eye);
    const double length2 = glm::dot(from_eye, from_eye);
    if (!(v.z > 0) || length2 > kMaxObliquity * v.z * v.z) return false;
    const double per_depth = 1 / v.z;
    obliquity_ = std::max(obliquity_, length2 * per_depth * per_depth);
    reach.near = std::min(reach.near, v.z);
    reach.far = std::max(reach.far, v.z);
    reach.distance = std::max(reach.distance, length2);
    seen = {v.x * per_depth, v.y * per_depth};
    bounds.grow(seen);
    return true;
  }
  void finish() noexcept { reach.distance = std::sqrt(reach.distance); }
  [[nodiscard]] double epsilon() const noexcept { return 16 * kRoundoff * obliquity_ * plane_.scale; }

  Reach reach;
  ImageBounds bounds;

private:
  const ImagePlane& plane_;
  double obliquity_ = 1;
};

std::optional<Projected> project_triangle(const ImagePlane& plane, const Pools& pools, PrimRef prim) noexcept {
  const TrianglePool& pool = pools.triangles;
  Outline outline(plane, prim);
  Vertices vertices(plane);
  std::array<dvec2, 3> p;
  std::array<double, 3> depth{};
  for (std::size_t k = 0; k < 3; ++k) {
    const dvec3 vertex = point(pool.vertex[k], prim.index);
    depth[k] = glm::dot(plane.center, vertex - plane.eye);
    if (vertices.add(vertex, p[k])) continue;
    return reach_of(plane, tight_bounds(pools, prim)).behind() ? std::nullopt : outline.everywhere();
  }
  vertices.finish();
  outline.set_bounds(vertices.bounds, vertices.epsilon());
  const dvec2 b = p[1] - p[0], c = p[2] - p[0];
  const double area = b.x * c.y - b.y * c.x;
  // Beyond the roundings of the area in double, with coordinates whose own errors epsilon covers.
  if (std::abs(area) > 0x1p-40 * (std::abs(b.x * c.y) + std::abs(b.y * c.x))) {
    for (std::size_t k = 0; k < 3; ++k) {
      const dvec2& from = p[k];
      const dvec2 along = p[(k + 1) % 3] - from;
      const dvec2 inwards = area > 0 ? dvec2(-along.y, along.x) : dvec2(along.y, -along.x);
      outline.add_edge(inwards, glm::dot(inwards, from));
    }
    const double at_b = 1 / depth[1] - 1 / depth[0], at_c = 1 / depth[2] - 1 / depth[0];
    const dvec2 normal = dvec2(at_b * c.y - at_c * b.y, at_c * b.x - at_b * c.x) / area;
    const Reach& reach = vertices.reach;
    outline.set_plane(normal, 1 / depth[0] - glm::dot(normal, p[0]), (256 + 32 * reach.distance / reach.near) * kRoundoff, 0);
  }
  return outline.finished(vertices.reach);
}

/// The plane that the kernel takes t from.
void set_polygon_plane(const ImagePlane& plane, const PolygonPool& pool, std::size_t i, Outline& outline) noexcept {
  const auto first = static_cast<std::size_t>(pool.first_vertex[i]), end = static_cast<std::size_t>(pool.first_vertex[i + 1]);
  const dvec3 normal = point(pool.normal, i), start = point(pool.vertex, first);
  double off_plane = 0;
  for (std::size_t k = first + 1; k < end; ++k) off_plane = std::max(off_plane, std::abs(glm::dot(normal, point(pool.vertex, k) - start)));
  const double height = glm::dot(normal, start - plane.eye), length = glm::length(normal);
  const dvec3 camera = plane.to_camera(normal);  // its parts along the steps from half sample to half sample are normal . right / right^2
  const double per_step2 = 1 / (plane.scale * plane.scale);
  const double relative = (8 * kRoundoff * length * glm::length(start - plane.eye) + 2 * off_plane) / std::abs(height) + 256 * kRoundoff;
  outline.set_plane(dvec2(camera.x, camera.y) * (per_step2 / height), camera.z / height, relative,
                    8 * kRoundoff * length * std::sqrt(plane.obliquity) / std::abs(height));
}

std::optional<Projected> project_polygon(const ImagePlane& plane, const Pools& pools, PrimRef prim) noexcept {
  const PolygonPool& pool = pools.polygons;
  Outline outline(plane, prim);
  Vertices vertices(plane);
  const auto first = static_cast<std::size_t>(pool.first_vertex[prim.index]), end = static_cast<std::size_t>(pool.first_vertex[prim.index + 1]);
  // At grazing incidence t may be anywhere in the box.
  const Reach reach = reach_of(plane, tight_bounds(pools, prim));
  dvec2 start(0), farthest(0);
  double farthest2 = -1;
  for (std::size_t k = first; k < end; ++k) {
    dvec2 seen(0);
    if (!vertices.add(point(pool.vertex, k), seen)) return reach.behind() ? std::nullopt : outline.everywhere();
    if (k == first) start = seen;
    const double distance2 = glm::dot(seen - start, seen - start);
    if (distance2 <= farthest2) continue;
    farthest2 = distance2;
    farthest = seen;
  }
  outline.set_bounds(vertices.bounds, vertices.epsilon());
  // A strip along the longest way across: slanted slender polygons fill little of their bounds.
  const dvec2 normal(start.y - farthest.y, farthest.x - start.x);
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t k = first; k < end; ++k) {
    dvec2 seen(0);
    vertices.add(point(pool.vertex, k), seen);
    low = std::min(low, glm::dot(normal, seen));
    high = std::max(high, glm::dot(normal, seen));
  }
  outline.add_edge(normal, low);
  outline.add_edge(-normal, -high);
  set_polygon_plane(plane, pool, prim.index, outline);
  return outline.finished(reach);
}

/// A sphere in camera space, x and y in units of the depth.
struct Ball {
  dvec3 center;
  double radius;

  [[nodiscard]] bool before_eye() const noexcept { return center.z - radius > 0x1p-10 * glm::length(center); }
  /// The silhouette's least and greatest x y . direction, a unit vector.
  [[nodiscard]] dvec2 silhouette(const dvec2& direction) const noexcept {
    const double across = direction.x * center.x + direction.y * center.y;
    const double depth2 = center.z * center.z - radius * radius;
    const double spread = radius * std::sqrt(across * across + depth2);
    return {(across * center.z - spread) / depth2, (across * center.z + spread) / depth2};
  }
};

/// The hull of balls.
std::optional<Projected> project_balls(const ImagePlane& plane, std::span<const Ball> balls, const Reach& reach, PrimRef prim) noexcept {
  Outline outline(plane, prim);
  if (reach.behind()) return std::nullopt;
  if (!std::all_of(balls.begin(), balls.end(), [](const Ball& ball) { return ball.before_eye(); })) return outline.everywhere();
  const auto silhouette = [&](const dvec2& direction) noexcept {
    dvec2 all(std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity());
    for (const Ball& ball : balls) {
      const dvec2 one = ball.silhouette(direction) * plane.scale;
      all = {std::min(all.x, one.x), std::max(all.y, one.y)};
    }
    return all;
  };
  const dvec2 x = silhouette({1, 0}), y = silhouette({0, 1});
  outline.set_bounds({{x.x, y.x}, {x.y, y.y}}, 16 * kRoundoff * plane.obliquity * plane.scale);
  const dvec3 &base = balls.front().center, &apex = balls.back().center;
  const dvec2 along(apex.x / apex.z - base.x / base.z, apex.y / apex.z - base.y / base.z);
  if (const double length = glm::length(along); length > 0) {
    const dvec2 normal = dvec2(-along.y, along.x) / length;
    const dvec2 strip = silhouette(normal);
    outline.add_edge(normal, strip.x);
    outline.add_edge(-normal, -strip.y);
  }
  return outline.finished(reach);
}

Ball ball_at(const ImagePlane& plane, const dvec3& center, double radius) noexcept {
  const dvec3 camera = plane.to_camera(center - plane.eye);
  return {{camera.x / plane.scale, camera.y / plane.scale, camera.z}, radius};
}

std::optional<Projected> project_round(const ImagePlane& plane, const Pools& pools, PrimRef prim) noexcept {
  const Aabb box = tight_bounds(pools, prim);
  const Reach reach = reach_of(plane, box);
  const double size = glm::length(dvec3(box.max) - dvec3(box.min));
  const double margin = kSurfaceError * (reach.distance + 2 * size);
  const std::size_t i = prim.index;
  if (prim.kind() == PrimKind::sphere) {
    const std::array ball{ball_at(plane, point(pools.spheres.center, i), double{pools.spheres.radius[i]} + margin)};
    return project_balls(plane, ball, reach, prim);
  }
  const ConePool& cones = pools.cones;
  const dvec3 base = point(cones.base, i);
  const std::array balls{ball_at(plane, base, double{cones.radius[0][i]} + margin),
                         ball_at(plane, base + point(cones.axis, i), double{cones.radius[1][i]} + margin)};
  return project_balls(plane, balls, reach, prim);
}

}  // namespace

ImagePlane::ImagePlane(const CameraModel& model) noexcept : width(model.width), height(model.height) {
  const EyeRays rays(model);
  eye = dvec3(glm::vec3(rays.eye()));
  center = rays.center();
  right = rays.right() / glm::dot(rays.right(), rays.right());
  down = rays.down() / glm::dot(rays.down(), rays.down());
  scale = glm::length(right);
  const double x = (width - 1) / scale, y = (height - 1) / scale;
  obliquity = 1 + x * x + y * y;
}

dvec3 ImagePlane::to_camera(const dvec3& from_eye) const noexcept { return {glm::dot(right, from_eye), glm::dot(down, from_eye), glm::dot(center, from_eye)}; }

std::optional<Projected> projected(const ImagePlane& plane, const Pools& pools, PrimRef prim) noexcept {
  if (!(plane.obliquity <= kMaxObliquity)) return Outline(plane, prim).everywhere();
  switch (prim.kind()) {
    case PrimKind::triangle: return project_triangle(plane, pools, prim);
    case PrimKind::polygon: return project_polygon(plane, pools, prim);
    case PrimKind::sphere:
    case PrimKind::cone: break;
  }
  return project_round(plane, pools, prim);
}

}  // namespace raymeter
