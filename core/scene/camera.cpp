#include "core/scene/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace raymeter {

namespace {

/// v as a unit vector, or `otherwise` where it has no direction.
glm::dvec3 unit_or(const glm::dvec3& v, const glm::dvec3& otherwise) noexcept {
  const double length = glm::length(v);
  return length > 0 && std::isfinite(length) ? v / length : otherwise;
}

/// All conventions are (2i - (N-1)) / intervals: this is `intervals`.
int intervals(CameraConvention convention, int samples) noexcept {
  switch (convention) {
    case CameraConvention::spd: return std::max(1, samples - 2);
    case CameraConvention::havran: return std::max(1, samples - 1);
    case CameraConvention::pixel: break;
  }
  return samples;
}

}  // namespace

EyeRays::EyeRays(const CameraModel& model) noexcept : eye_(model.camera.eye), width_(model.width), height_(model.height) {
  const Camera& camera = model.camera;
  center_ = unit_or(camera.look_at - camera.eye, {0.0, 0.0, -1.0});
  const glm::dvec3 axis = std::abs(center_.y) < 0.5 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
  const glm::dvec3 right = unit_or(glm::cross(center_, camera.up), glm::normalize(glm::cross(center_, axis)));
  const double half_step = std::tan(camera.fov_degrees * std::numbers::pi / 360) / intervals(model.convention, model.height);
  right_ = half_step * right;
  down_ = half_step * glm::cross(center_, right);
}

glm::dvec3 EyeRays::direction(int x, int y) const noexcept {
  return glm::normalize(center_ + static_cast<double>(2 * x - (width_ - 1)) * right_ + static_cast<double>(2 * y - (height_ - 1)) * down_);
}

}  // namespace raymeter
