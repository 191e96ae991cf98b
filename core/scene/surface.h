#pragma once

#include <cstdint>

#include <glm/vec3.hpp>

#include "core/geometry/error_bounds.h"
#include "core/ray/ray_batch.h"
#include "core/scene/light_target.h"
#include "core/scene/scene.h"

namespace raymeter {

/// A ray that starts this much of a primitive's diameter off its surface (on the outer side of spheres and cones) and moves away does not meet it. Spheres,
/// cones: a hit would be kSurfaceError of the diameter off the surface; the way to it counts for nothing, as the ray gains on them with its square. Triangles,
/// h the origin's height, u = kUnitRoundoff, D the diameter: what the kernel meets in front of the origin it sees 6 u D too high across the ray at most
/// (triangle_kernel.h, |S| <= 1), so that h <= 7 u D with the direction's rounding. What lies behind the origin counts as t >= 0 if t errs by 12 u s; s times
/// the ray's climb from the plane is at most 1.6 D, and the weights are those of a point below the origin, so that vertices are D / sqrt(3) away in the mean:
/// h <= (19 + 3.5) u D. Polygons: 8 u (D + D).
inline constexpr float kLeavingError = 32 * kUnitRoundoff;

/// A hit, recomputed in double from the ray and the primitive: what the float kernels found says only which primitive and which of its roots.
struct Surface {
  glm::dvec3 point{0.0};
  /// Unit, to the outside: from a sphere's centre, from a cone's axis, to the side from which a triangle or polygon runs counterclockwise.
  glm::dvec3 geometric{0.0};
  /// Unit: the interpolated vertex normal, with the sign that the vertices give it, or the geometric normal.
  glm::dvec3 shading{0.0};
  /// How far from the surface a spawned ray starts: kLeavingError of the primitive's diameter, so that it does not meet what it leaves; 16
  /// unit roundoffs of the distance that the hit was seen from, since another primitive up to two kernel errors in front could not be told from this one; and
  /// 2 of the point's coordinates, for rounding the origin, for polygons 2 more, for rounding their vertices.
  double clearance = 0;
};

/// The surface that `ray` meets at about `t` on primitive `prim`.
[[nodiscard]] Surface surface_at(const Scene& scene, const Ray& ray, float t, std::int32_t prim) noexcept;

/// A ray from the surface: its origin is lifted off by the clearance, to the side that `dir` points to. It meets nothing nearer than `distance_min`.
[[nodiscard]] Ray spawn_ray(const Surface& surface, const glm::dvec3& dir, double distance_min = 0) noexcept;
/// The same towards `target`, which lies at t = 1 and is excluded: t_max is one ulp below. A target lower than the clearance is lifted to it.
[[nodiscard]] Ray spawn_ray_to(const Surface& surface, const glm::dvec3& target, double distance_min = 0) noexcept;
/// The same towards a light, which no surface that it lies on hides: a shadow ray.
[[nodiscard]] Ray spawn_ray_to(const Surface& surface, const LightTarget& light, double distance_min = 0) noexcept;

}  // namespace raymeter
