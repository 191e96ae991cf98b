#include "core/bounds/sphere_volume.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <glm/geometric.hpp>

#include "core/bounds/outward_rounding.h"
#include "core/bounds/prim_hull.h"

namespace raymeter {

namespace {

constexpr int kTightSteps = 64;

/// The furthest distance of the hulls from `center`, and where that is.
double furthest_of(std::span<const PrimHull> hulls, const glm::dvec3& center, glm::dvec3& point) noexcept {
  double most = 0;
  for (const PrimHull& hull : hulls) {
    glm::dvec3 candidate;
    const double distance = hull.furthest(center, candidate);
    if (distance <= most) continue;
    most = distance;
    point = candidate;
  }
  return most;
}

}  // namespace

BoundingSphere SphereVolume::fit(const Scene& scene, std::span<const PrimRef> prims) const {
  std::vector<PrimHull> hulls;
  hulls.reserve(prims.size());
  Aabb box;
  for (const PrimRef prim : prims) {
    hulls.push_back(prim_hull(scene.pools(), prim));
    box.grow(tight_bounds(scene.pools(), prim));
  }
  // Each centre is rounded to float before its radius is measured.
  BoundingSphere best{glm::vec3((glm::dvec3(box.min) + glm::dvec3(box.max)) / 2.0), 0};
  glm::dvec3 center(best.center), point(center);
  double least = furthest_of(hulls, center, point);
  for (int step = 1; tight && step <= kTightSteps; ++step) {
    center += (point - center) / (step + 1.0);
    const glm::vec3 rounded(center);
    const double radius = furthest_of(hulls, glm::dvec3(rounded), point);
    if (radius >= least) continue;
    least = radius;
    best.center = rounded;
  }
  best.radius = round_up(least);
  return best;
}

BoundingSphere SphereVolume::merge(const BoundingSphere& a, const BoundingSphere& b) const noexcept {
  constexpr double kRoundings = 1 + 0x1p-48;
  const glm::dvec3 to_b = glm::dvec3(b.center) - glm::dvec3(a.center);
  const double distance = glm::length(to_b) * kRoundings, ra = double{a.radius}, rb = double{b.radius};
  if (distance + rb <= ra) return a;
  if (distance + ra <= rb) return b;
  const double radius = (distance + ra + rb) / 2;
  const glm::vec3 center(glm::dvec3(a.center) + to_b * ((radius - ra) / distance));
  const double reach_a = glm::length(glm::dvec3(center) - glm::dvec3(a.center)) + ra;
  const double reach_b = glm::length(glm::dvec3(center) - glm::dvec3(b.center)) + rb;
  return {center, round_up(std::max(reach_a, reach_b) * kRoundings)};
}

double SphereVolume::half_area(const BoundingSphere& sphere) const noexcept { return 2 * std::numbers::pi * double{sphere.radius} * double{sphere.radius}; }

double SphereVolume::enclosed(const BoundingSphere& sphere) const noexcept { return half_area(sphere) * double{sphere.radius} * 2 / 3; }

void SphereVolume::write(const BoundingSphere& sphere, float* data) const noexcept {
  for (glm::length_t a = 0; a < 3; ++a) data[a] = sphere.center[a];
  data[3] = sphere.radius;
}

}  // namespace raymeter
