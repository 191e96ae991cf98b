#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "accel/registry.h"
#include "core/trace/trace.h"

namespace raymeter::test {

inline constexpr float kInf = std::numeric_limits<float>::infinity();
inline constexpr float kDenormal = std::numeric_limits<float>::denorm_min();

/// Uniform in [0, 1), the same on every library.
inline double uniform(std::mt19937& random) { return static_cast<double>(random()) * 0x1p-32; }
inline glm::dvec3 point(std::mt19937& random) {
  const double x = uniform(random), y = uniform(random);
  return {x, y, uniform(random)};
}
template <class T>
const T& pick(std::mt19937& random, const std::vector<T>& from) {
  return from[random() % from.size()];
}

/// All kinds, in a unit cube that is scaled and moved.
inline Scene mixed_scene(int count, double size, double scale = 1, const glm::dvec3& offset = glm::dvec3(0.0)) {
  std::mt19937 random(1);
  Scene scene;
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 p = offset + scale * point(random), e = scale * size * point(random), f = scale * size * point(random);
    const std::array<glm::dvec3, 4> quad{p, p + e, p + e + f, p + f};
    switch (i % 4) {
      case 0: scene.add_triangle(p, p + e, p + f); break;
      case 1: scene.add_sphere(p, 0.5 * scale * size * uniform(random)); break;
      case 2: scene.add_cone(p, 0.1 * scale * size, p + e, 0.05 * scale * size); break;
      default: scene.add_polygon(quad);
    }
  }
  scene.finish();
  return scene;
}

inline Ray ray(const glm::dvec3& from, const glm::dvec3& dir, float t_max = kInf) {
  const glm::vec3 o(from), d(dir);
  return {{o.x, o.y, o.z}, 0, {d.x, d.y, d.z}, t_max};
}

/// Rays of every direction through the scene's box, from inside and outside.
inline RayBatch random_rays(int count, double scale = 1, const glm::dvec3& offset = glm::dvec3(0.0)) {
  std::mt19937 random(2);
  RayBatch rays;
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 from = offset + scale * (3.0 * point(random) - 1.0), to = offset + scale * point(random);
    rays.push_back(ray(from, to - from));
  }
  return rays;
}

/// Where planes are on each axis.
using Planes = std::array<std::vector<float>, 3>;

/// Rays, no two the same, from planes, edges and corners, or just beside them, along and across them, with zero, denormal and huge directions; some also go
/// backwards, some come from far away.
inline RayBatch plane_rays(int count, const Planes& planes) {
  std::mt19937 random(3);
  const std::vector<float> speeds{0, -0.0f, 1, -1, 0.5f, -2, 1 + 0x1p-23f, kDenormal, -kDenormal, 0x1p-127f, -0x1p-126f, 1e-20f, 1e20f, 0x1p127f};
  std::unordered_set<std::uint64_t> seen;
  seen.reserve(static_cast<std::size_t>(count));
  RayBatch rays;
  while (static_cast<int>(rays.size()) < count) {
    Ray r{{0, 0, 0}, 0, {0, 0, 0}, kInf};
    for (std::size_t a = 0; a < 3; ++a) {
      r.org[a] = pick(random, planes[a]);
      switch (random() % 8) {
        case 0: r.org[a] = std::nextafter(r.org[a], kInf); break;
        case 1: r.org[a] = std::nextafter(r.org[a], -kInf); break;
        case 2: r.org[a] += static_cast<float>(uniform(random)); break;
        default: break;
      }
      r.dir[a] = random() % 4 == 0 ? static_cast<float>(2 * uniform(random) - 1) : pick(random, speeds);
    }
    if (random() % 32 == 0) r.t_min = -kInf;
    if (random() % 32 == 0) r.org[random() % 3] = 1e30f;
    std::uint64_t key = 0;
    for (const float x : {r.org[0], r.org[1], r.org[2], r.t_min, r.dir[0], r.dir[1], r.dir[2]}) {
      key = (key ^ std::bit_cast<std::uint32_t>(x)) * 0x9E3779B97F4A7C15u;
      key ^= key >> 32;
    }
    if (seen.insert(key).second) rays.push_back(r);
  }
  return rays;
}

/// Such rays about a grid over [0, n]^3 with unit cells, and the middles of its cells.
inline RayBatch lattice_rays(int count, int n) {
  Planes planes;
  for (auto& on_axis : planes) {
    for (int i = -4; i < 2 * n + 5; ++i) on_axis.push_back(static_cast<float>(i) / 2);
  }
  return plane_rays(count, planes);
}

}  // namespace raymeter::test
