#include <array>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "experiments/scenes/gen/gen_scene.h"
#include "experiments/scenes/gen/random_points.h"

namespace raymeter {

namespace {

constexpr int kSegments = 24;
constexpr std::size_t kSides = 3;
constexpr double kSegmentLength = 0.06;
constexpr double kRootSphere = 0.37;
using Ring = std::array<glm::dvec3, kSides>;

/// The corners of a tube about `center`. `side` is turned as little as makes it perpendicular to the tube, so that the tube does not twist.
Ring ring(const glm::dvec3& center, const glm::dvec3& along, glm::dvec3& side, double radius) noexcept {
  side = glm::normalize(side - glm::dot(side, along) * along);
  const glm::dvec3 other = glm::cross(along, side);
  Ring corners;
  for (std::size_t k = 0; k < kSides; ++k) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(k) / kSides;
    corners[k] = center + radius * (std::cos(angle) * side + std::sin(angle) * other);
  }
  return corners;
}

/// A strand grows outwards from the root sphere in a random walk; beyond the unit sphere it is drawn back, so that strands curl and tangle.
void add_strand(Scene& scene, RandomStream random) {
  glm::dvec3 direction = uniform_direction(random);
  glm::dvec3 center = kRootSphere * direction;
  glm::dvec3 side = glm::cross(direction, std::abs(direction.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0));
  const auto radius = [](int k) { return 0.004 - 0.0036 * k / kSegments; };  // thins out towards the tip
  scene.begin_object("strand");
  Ring corners = ring(center, direction, side, radius(0));
  for (int k = 1; k <= kSegments; ++k) {
    const glm::dvec3 pull = glm::length(center) > 1 ? -0.25 * center : glm::dvec3(0.0);
    direction = glm::normalize(direction + 0.5 * uniform_in_cube(random, -1, 1) + pull);
    center += kSegmentLength * direction;
    const Ring next = ring(center, direction, side, radius(k));
    for (std::size_t i = 0; i < kSides; ++i) {
      const std::size_t j = (i + 1) % kSides;
      scene.add_triangle(corners[i], corners[j], next[j]);
      scene.add_triangle(corners[i], next[j], next[i]);
    }
    corners = next;
  }
  scene.end_object();
}

}  // namespace

Scene make_hairball(int strands) {
  constexpr std::uint64_t kSeed = 12345;
  Scene scene = gen_scene({0, -5, 2}, {0, 0, 0}, {0, 0, 1}, 35, {4, -6, 6});
  scene.reserve(PrimKind::triangle, 2 * kSides * kSegments * static_cast<std::size_t>(strands));
  scene.set_material({.color = {0.6, 0.4, 0.25}, .diffuse = 0.9, .specular = 0.1, .shine = 20});
  for (int strand = 0; strand < strands; ++strand) add_strand(scene, RandomStream(kSeed, static_cast<std::uint64_t>(strand)));
  return scene;
}

}  // namespace raymeter
