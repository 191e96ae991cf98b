#include "experiments/scenes/spd/teapot_mesh.h"

#include <algorithm>
#include <array>
#include <vector>

#include <glm/geometric.hpp>

#include "experiments/scenes/spd/teapot_patches.h"

namespace raymeter {

namespace {

/// A point of the surface and the unit normal there, outwards.
struct SurfacePoint {
  glm::dvec3 position;
  glm::dvec3 normal;
  [[nodiscard]] bool on_axis() const noexcept { return position.x == 0 && position.y == 0; }
};

/// The four cubic Bernstein polynomials at a parameter, and their derivatives.
struct Bernstein {
  explicit Bernstein(double t) noexcept
      : value{(1 - t) * (1 - t) * (1 - t), 3 * t * (1 - t) * (1 - t), 3 * t * t * (1 - t), t * t * t},
        slope{-3 * (1 - t) * (1 - t), 3 * (1 - t) * (1 - 3 * t), 3 * t * (2 - 3 * t), 3 * t * t} {}
  std::array<double, 4> value;
  std::array<double, 4> slope;
};

SurfacePoint surface_point(const std::array<std::uint16_t, 16>& patch, const Bernstein& s, const Bernstein& t) {
  glm::dvec3 position(0.0), along_s(0.0), along_t(0.0);
  for (std::size_t row = 0; row < 4; ++row) {
    for (std::size_t column = 0; column < 4; ++column) {
      const glm::dvec3& control = kTeapotPoints[patch[4 * row + column]];
      position += s.value[row] * t.value[column] * control;
      along_s += s.slope[row] * t.value[column] * control;
      along_t += s.value[row] * t.slope[column] * control;
    }
  }
  SurfacePoint point{position, {}};
  // At the poles of the lid and of the bottom a whole edge of the patch is one point and a tangent vanishes.
  if (point.on_axis())
    point.normal = {0, 0, position.z > 1.5 ? 1 : -1};
  else
    point.normal = glm::normalize(glm::cross(along_t, along_s));
  return point;
}

void add_triangle(Scene& scene, const std::array<const SurfacePoint*, 3>& corners, double scale, const glm::dvec3& origin) {
  if (std::count_if(corners.begin(), corners.end(), [](const SurfacePoint* corner) { return corner->on_axis(); }) > 1) return;
  std::array<glm::dvec3, 3> vertex, normal;
  for (std::size_t k = 0; k < 3; ++k) {
    vertex[k] = origin + scale * corners[k]->position;
    normal[k] = corners[k]->normal;
  }
  scene.add_triangle(vertex, normal);
}

}  // namespace

void add_teapot(Scene& scene, int divisions, double scale, const glm::dvec3& origin) {
  const auto n = static_cast<std::size_t>(divisions);
  std::vector<Bernstein> at;  // at the borders of the parameter quads
  for (int i = 0; i <= divisions; ++i) at.emplace_back(static_cast<double>(i) / divisions);
  std::vector<SurfacePoint> points((n + 1) * (n + 1));
  scene.begin_object("teapot");
  for (const auto& patch : kTeapotPatches) {
    for (std::size_t i = 0; i <= n; ++i) {
      for (std::size_t j = 0; j <= n; ++j) points[i * (n + 1) + j] = surface_point(patch, at[i], at[j]);
    }
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) {
        const SurfacePoint* const near = &points[i * (n + 1) + j];
        const SurfacePoint* const far = near + n + 1;
        add_triangle(scene, {near, near + 1, far + 1}, scale, origin);
        add_triangle(scene, {far + 1, far, near}, scale, origin);
      }
    }
  }
  scene.end_object();
}

}  // namespace raymeter
