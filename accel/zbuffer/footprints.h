#pragma once

#include <optional>

#include <glm/vec3.hpp>

#include "accel/zbuffer/footprint_layout.h"
#include "core/base/column.h"
#include "core/scene/camera.h"
#include "core/scene/scene.h"

namespace raymeter {

/// The view of a camera model in the terms of footprints. The eye is where the rays start: rounded to float.
struct ImagePlane {
  explicit ImagePlane(const CameraModel& model) noexcept;
  /// From world space relative to the eye: x and y in half samples at depth 1, z the depth.
  [[nodiscard]] glm::dvec3 to_camera(const glm::dvec3& from_eye) const noexcept;

  glm::dvec3 eye;
  glm::dvec3 center, right, down;
  int width, height;
  double scale;      ///< half samples per unit on the plane at depth 1
  double obliquity;  ///< square of the longest distance from the eye to a sample on that plane
};

/// What a primitive covers, and at which depth.
struct Projected {
  Footprint print;
  DepthPlane plane;
};

/// Empty where no sample can see the primitive.
[[nodiscard]] std::optional<Projected> projected(const ImagePlane& plane, const Pools& pools, PrimRef prim) noexcept;

}  // namespace raymeter
