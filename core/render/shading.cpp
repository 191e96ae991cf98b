#include "core/render/shading.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace raymeter {

SurfaceRules surface_rules(CameraConvention convention) noexcept {
  if (convention == CameraConvention::havran) return {false, 0.01};
  return {};
}

glm::dvec3 mirrored(const ShadingPoint& point) noexcept { return glm::reflect(point.dir, point.normal); }

std::optional<glm::dvec3> transmitted(const ShadingPoint& point) noexcept {
  const double along = glm::dot(point.dir, point.normal);
  const glm::dvec3 against = along > 0 ? -point.normal : point.normal;
  const double cosine = std::abs(along);  // times the direction's length, as what follows
  const bool enters = glm::dot(point.dir, point.surface.geometric) < 0;
  const double eta = enters ? 1 / point.material->ior : point.material->ior;
  const double squared = (1 - eta * eta) * glm::dot(point.dir, point.dir) + (eta * cosine) * (eta * cosine);
  if (!(squared >= 0)) return std::nullopt;
  return eta * point.dir + (eta * cosine - std::sqrt(squared)) * against;
}

bool faces(const ShadingPoint& point, const Light& light) noexcept { return glm::dot(point.normal, light.position - point.surface.point) > 0; }

glm::dvec3 phong(const ShadingPoint& point, const Light& light) noexcept {
  const Material& material = *point.material;
  const glm::dvec3 to_light = glm::normalize(light.position - point.surface.point);
  glm::dvec3 radiance = material.diffuse * std::max(0.0, glm::dot(point.normal, to_light)) * material.color;
  if (material.specular > 0) {
    const double highlight = std::max(0.0, glm::dot(glm::normalize(mirrored(point)), to_light));
    radiance += glm::dvec3(material.specular * std::pow(highlight, material.shine));
  }
  return light.color * radiance;
}

}  // namespace raymeter
