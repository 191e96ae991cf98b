#pragma once

#include <cstdint>

#include <glm/vec3.hpp>

#include "core/ray/ray_batch.h"
#include "core/scene/light_target.h"
#include "core/scene/scene.h"

namespace raymeter {

/// A hit, recomputed in double from the ray and the primitive: what the float kernels found says only which primitive and which of its roots.
struct Surface {
  glm::dvec3 point{0.0};
  /// Unit, to the outside: from a sphere's centre, from a cone's axis, to the side from which a triangle or polygon runs counterclockwise.
  glm::dvec3 geometric{0.0};
  /// Unit: the interpolated vertex normal, with the sign that the vertices give it, or the geometric normal.
  glm::dvec3 shading{0.0};
  /// How far from the surface a spawned ray starts. In units of float rounding (error_bounds.h): 16 of the primitive's size, more than its kernel errs for a
  /// ray from close by; 16 of the distance that the hit was seen from, since another primitive up to two kernel errors in front could not be told from this
  /// one; and 2 of the point's coordinates, for rounding the origin.
  double clearance = 0;
};

/// The surface that `ray` meets at about `t` on primitive `prim`.
[[nodiscard]] Surface surface_at(const Scene& scene, const Ray& ray, float t, std::int32_t prim) noexcept;

/// A ray from the surface: its origin is lifted off by the clearance, to the side that `dir` points to. It meets nothing nearer than `distance_min`.
[[nodiscard]] Ray spawn_ray(const Surface& surface, const glm::dvec3& dir, double distance_min = 0) noexcept;
/// The same towards `target`, which lies at t = 1 and is excluded: t_max is one ulp below.
[[nodiscard]] Ray spawn_ray_to(const Surface& surface, const glm::dvec3& target, double distance_min = 0) noexcept;
/// The same towards a light, which no surface that it lies on hides: a shadow ray.
[[nodiscard]] Ray spawn_ray_to(const Surface& surface, const LightTarget& light, double distance_min = 0) noexcept;

}  // namespace raymeter
