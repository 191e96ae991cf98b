#include "experiments/scenes/face.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace raymeter {

namespace {

/// Distance from its plane, relative to the face's extent, up to which a face counts as planar: what 6 digits in a file leave of a planar face.
constexpr double kPlanarity = 1e-5;

/// Newell's normal about vertex 0, of unit length; NaN for faces without an area.
glm::dvec3 unit_normal(std::span<const glm::dvec3> vertices) noexcept {
  glm::dvec3 normal(0.0);
  for (std::size_t k = 1; k + 1 < vertices.size(); ++k) normal += glm::cross(vertices[k] - vertices[0], vertices[k + 1] - vertices[0]);
  return glm::normalize(normal);
}

bool is_planar(std::span<const glm::dvec3> vertices, const glm::dvec3& normal) noexcept {
  glm::dvec3 min = vertices[0], max = vertices[0];
  double distance = 0;
  for (const glm::dvec3& vertex : vertices) {
    min = glm::min(min, vertex);
    max = glm::max(max, vertex);
    distance = std::max(distance, std::abs(glm::dot(vertex - vertices[0], normal)));
  }
  return distance <= kPlanarity * glm::length(max - min);
}

/// All corners turn the same way about the normal; false for faces without an area or with coordinates that are not finite.
bool is_convex(std::span<const glm::dvec3> vertices, const glm::dvec3& normal) noexcept {
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const glm::dvec3& corner = vertices[(k + 1) % vertices.size()];
    const glm::dvec3 before = corner - vertices[k];
    const glm::dvec3 after = vertices[(k + 2) % vertices.size()] - corner;
    if (!(glm::dot(glm::cross(before, after), normal) >= 0)) return false;
  }
  return true;
}

}  // namespace

void add_face(Scene& scene, std::span<const glm::dvec3> vertices, std::span<const glm::dvec3> normals) {
  const auto add_triangle = [&](std::size_t a, std::size_t b, std::size_t c) {
    if (normals.empty())
      scene.add_triangle(vertices[a], vertices[b], vertices[c]);
    else
      scene.add_triangle(std::array{vertices[a], vertices[b], vertices[c]}, {normals[a], normals[b], normals[c]});
  };
  if (vertices.size() == 3) return add_triangle(0, 1, 2);
  const glm::dvec3 normal = unit_normal(vertices);
  const bool flat_shaded = std::all_of(normals.begin(), normals.end(), [&](const glm::dvec3& n) { return n == normals[0]; });
  if ((flat_shaded && is_planar(vertices, normal)) || !is_convex(vertices, normal)) return scene.add_polygon(vertices);
  for (std::size_t k = 1; k + 1 < vertices.size(); ++k) add_triangle(0, k, k + 1);
}

}  // namespace raymeter
