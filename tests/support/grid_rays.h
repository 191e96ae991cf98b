#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <string_view>
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

/// Rays whose origins and directions fall on planes, edges and corners of a grid over [0, n]^3 with unit cells, or just beside them.
inline RayBatch lattice_rays(int count, int n) {
  std::mt19937 random(3);
  const std::vector<float> speeds{0, -0.0f, 1, -1, 0.5f, -2, 1 + 0x1p-23f, kDenormal, -kDenormal, 0x1p-127f, -0x1p-126f, 1e-20f, 1e20f, 0x1p127f};
  RayBatch rays;
  while (static_cast<int>(rays.size()) < count) {
    Ray r{{0, 0, 0}, 0, {0, 0, 0}, kInf};
    for (std::size_t a = 0; a < 3; ++a) {
      r.org[a] = static_cast<float>(static_cast<int>(random() % static_cast<unsigned>(2 * n + 9)) - 4) / 2;
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
    rays.push_back(r);
  }
  return rays;
}

}  // namespace raymeter::test
