#pragma once

#include <cstdint>
#include <optional>

#include <glm/vec3.hpp>

#include "core/scene/camera.h"
#include "core/scene/scene.h"
#include "core/scene/surface.h"

namespace raymeter {

/// What a comparison demands of surfaces, beside its samples.
struct SurfaceRules {
  /// Both sides are lit: the shading normal is turned against the incoming ray. Otherwise it stays outward, and only lights outside reach a surface.
  bool two_sided = true;
  /// Nothing nearer than this, in scene units, stops a spawned ray.
  double distance_min = 0;
};
[[nodiscard]] SurfaceRules surface_rules(CameraConvention convention) noexcept;

/// A hit as shading sees it.
struct ShadingPoint {
  Surface surface;
  glm::dvec3 dir;     ///< of the incoming ray, as traced
  glm::dvec3 normal;  ///< unit; what light and mirror directions are measured against
  const Material* material;
  std::int32_t slot;  ///< of the pixel
  glm::vec3 weight;   ///< share of the hit's radiance in the pixel's
  std::int32_t prim;
};

/// The mirrored direction; as long as the incoming one.
[[nodiscard]] glm::dvec3 mirrored(const ShadingPoint& point) noexcept;
/// The transmitted direction by Snell's law, as long as the incoming one, and exactly it where the index is 1; empty on total internal reflection.
/// Rays that come from outside (geometric normal) enter the medium, all others leave it for index 1.
[[nodiscard]] std::optional<glm::dvec3> transmitted(const ShadingPoint& point) noexcept;
/// Whether the surface is turned to the light.
[[nodiscard]] bool faces(const ShadingPoint& point, const Light& light) noexcept;
/// What a light that is not blocked adds to the hit's radiance (Phong 1975: diffuse in the material's colour, highlight in the light's).
[[nodiscard]] glm::dvec3 phong(const ShadingPoint& point, const Light& light) noexcept;

}  // namespace raymeter
