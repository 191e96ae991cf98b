#include "experiments/scenes/default_view.h"

#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "core/bounds/aabb.h"

namespace raymeter {

namespace {

struct Sphere {
  glm::dvec3 center{0.0};
  double radius = 1;
};

/// Around the bounding box of what can be hit; the unit sphere where there is nothing, or only a point.
Sphere bounding_sphere(const Scene& scene) {
  Aabb box;
  for (std::int32_t id = 0; id < scene.prim_id_count(); ++id) {
    const PrimRef ref = scene.prim(id);
    if (!ref.dropped()) box.grow(tight_bounds(scene.pools(), ref));
  }
  if (box.empty()) return {};
  const glm::dvec3 min(box.min), max(box.max);
  const double radius = glm::length(max - min) / 2;
  return {(min + max) / 2.0, radius > 0 ? radius : 1.0};
}

}  // namespace

void complete_view(Scene& scene, bool has_camera) {
  if (has_camera && !scene.lights.empty()) return;
  const Sphere bounds = bounding_sphere(scene);
  if (!has_camera) {
    Camera camera;
    const double distance = bounds.radius / std::sin(camera.fov_degrees / 2 * std::numbers::pi / 180);
    camera.look_at = bounds.center;
    camera.eye = bounds.center + distance * glm::normalize(glm::dvec3(0.5, 0.4, 1));
    camera.up = {0, 1, 0};
    scene.camera = camera;
  }
  if (scene.lights.empty()) scene.lights.push_back({bounds.center + 6 * bounds.radius * glm::normalize(glm::dvec3(-1, 2, 2)), glm::dvec3(1.0)});
}

}  // namespace raymeter
