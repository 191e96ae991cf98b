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

namespace {

/// The square of the transmitted ray's cosine, times that of the direction's length: negative on total internal reflection. At the critical angle its two terms
/// cancel, and what is left would be roundings: there 11 more bits decide.
double cosine_squared(const ShadingPoint& point, double eta, double cosine) noexcept {
  const double dir2 = glm::dot(point.dir, point.dir);
  const double squared = (1 - eta * eta) * dir2 + (eta * cosine) * (eta * cosine);
  if (eta <= 1 || std::abs(squared) >= 1e-12 * dir2) return squared;
  using Wide = glm::vec<3, long double>;
  const Wide dir(point.dir);
  const long double index = eta, along = index * glm::dot(dir, Wide(point.normal));
  return static_cast<double>((1 - index * index) * glm::dot(dir, dir) + along * along);
}

}  // namespace

std::optional<glm::dvec3> transmitted(const ShadingPoint& point) noexcept {
  const double along = glm::dot(point.dir, point.normal);
  const glm::dvec3 against = along > 0 ? -point.normal : point.normal;
  const double cosine = std::abs(along);  // times the direction's length, as what follows
  const bool enters = glm::dot(point.dir, point.surface.geometric) < 0;
  const double eta = enters ? 1 / point.material->ior : point.material->ior;
  const double squared = cosine_squared(point, eta, cosine);
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
