#pragma once

#include <limits>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "core/scene/scene.h"

namespace raymeter {

/// A primitive that a light is on, as its tangent plane there.
struct LightContact {
  glm::dvec3 normal{0.0};  ///< unit, to either side
  double height = 0;       ///< signed distance of the light from the surface, along the normal
  double size = 0;         ///< the diagonal of the primitive's box
  /// How far behind the tangent plane (where the normal does not point) the surface comes back: the radius there of spheres and cones.
  double room = std::numeric_limits<double>::infinity();
  /// At a cone's apex all of its tangent planes meet: there `normal` is the axis, to the outside, and a plane's normal is `along` times that and `across` times
  /// the perpendicular that points to whoever looks. Elsewhere `across` is 0.
  double along = 1;
  double across = 0;
};

/// A light is on a primitive where it is no further from it than this, relative to its coordinates' sum and the primitive's size: it was rounded.
inline constexpr double kLightTouch = 0x1p-22;
/// Height of a ray's end over a surface that the light is on, relative to the ray's length and the surface's size: what kernels promise at most, and what
/// rounding the direction and this adds.
inline constexpr double kLightLift = 0x1.2p-19;

/// A plane that a ray's end is to be above by so much; the normal is unit, and to the side of the ray's origin.
struct EndSide {
  glm::dvec3 normal{0.0};
  double light_height = 0;  ///< of the light above the plane
  double wanted = 0;        ///< of the end
};

/// Where shadow rays to a light end. Kernels are closed and t errs, so that a surface would hide a light on it at random. As a ray's origin is lifted off the
/// surface that it leaves, its end is lifted off the surfaces that the light is on, to the side from which it comes.
struct LightTarget {
  glm::dvec3 light{0.0};
  std::vector<LightContact> contacts;  ///< for most lights none

  /// Where a ray from `org` ends: at the light, or kLightLift * (|light - org| + size) above each tangent plane there, on the side of `org`; and above the
  /// plane of the surface that it leaves, `left`.
  ///
  /// Then no surface that the light is on is met, whatever the angle: heights over a plane, and depths in a convex body, are along the ray at least what is
  /// linear between its ends, and so is what kernels may err (error_bounds.h). Only an origin that is itself nearer to the surface than its kernel errs, and
  /// does not come from it, may be on the wrong side. A sphere or cone still hides what is behind it.
  ///
  /// What is nearer to the light than the end is no longer met; between planes that meet at right angles or more that is kLightLift * (|light - org| + size),
  /// in a narrower wedge at most so much divided by the sine of the ray's angle with the planes.
  [[nodiscard]] glm::dvec3 seen_from(const glm::dvec3& org, const EndSide& left) const noexcept;
};

/// The targets of lights in a scene, in their order.
[[nodiscard]] std::vector<LightTarget> light_targets(const Scene& scene, std::span<const Light> lights, int threads);

}  // namespace raymeter
