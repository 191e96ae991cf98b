#include "core/render/radiance_bound.h"

#include <cmath>
#include <limits>

#include <glm/common.hpp>

namespace raymeter {

namespace {

/// What lights give at most, each channel.
glm::dvec3 local_radiance(const Scene& scene, const Material& material) {
  glm::dvec3 share = glm::abs(material.diffuse * material.color);
  if (material.reflects()) share += material.shine >= 0 ? material.specular : std::numeric_limits<double>::infinity();
  glm::dvec3 light(0);
  for (const Light& one : scene.lights) light += glm::abs(one.color);
  for (glm::length_t channel = 0; channel < 3; ++channel) {
    if (light[channel] > 0) light[channel] *= share[channel];  // nothing of no light, even where the share is infinite
  }
  return light;
}

}  // namespace

std::vector<glm::dvec3> largest_radiance(const Scene& scene, int generations) {
  std::vector<glm::dvec3> most{glm::dvec3(0)};
  for (int r = 1; r <= generations; ++r) {
    glm::dvec3 radiance = glm::abs(scene.background);
    for (const Scene::MaterialRun& run : scene.material_runs()) {
      const Material& material = run.material;
      const double share = std::abs(material.specular) + std::abs(material.transmittance);
      const glm::dvec3 spawned = material.reflects() || material.transmits() ? share * most.back() : glm::dvec3(0);
      radiance = glm::max(radiance, local_radiance(scene, material) + spawned);
    }
    most.push_back(radiance);
  }
  return most;
}

glm::dvec3 largest_share(const glm::vec3& weight, const glm::dvec3& radiance) noexcept {
  glm::dvec3 share(0);
  for (glm::length_t channel = 0; channel < 3; ++channel) {
    if (weight[channel] != 0) share[channel] = std::abs(double{weight[channel]}) * radiance[channel];
  }
  return share;
}

glm::vec3 bound_of(const glm::dvec3& cut, const glm::dvec3& sum, int max_depth) noexcept {
  constexpr double kUnit = 0x1p-23;
  glm::vec3 bound(0);
  for (glm::length_t channel = 0; channel < 3; ++channel) {
    if (cut[channel] == 0) continue;
    const double most = cut[channel] * (1 + (max_depth + 2) * kUnit) + 2 * kUnit * std::abs(sum[channel]) + double{std::numeric_limits<float>::min()};
    bound[channel] = std::nextafter(static_cast<float>(most), std::numeric_limits<float>::infinity());
  }
  return bound;
}

}  // namespace raymeter
