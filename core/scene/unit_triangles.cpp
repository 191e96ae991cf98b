#include "core/scene/unit_triangles.h"

#include <cmath>
#include <limits>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "core/base/threads.h"
#include "core/scene/pools.h"

namespace raymeter {

namespace {

/// Writes the nine numbers of one map; returns its axis.
int map_to_unit(const TriangleView& pool, std::size_t triangle, float* map) noexcept {
  const std::size_t i = triangle * static_cast<std::size_t>(pool.stride);
  const auto vertex = [&](int k) { return glm::dvec3(pool.vertex[k][0][i], pool.vertex[k][1][i], pool.vertex[k][2][i]); };
  const glm::dvec3 a = vertex(0), ab = vertex(1) - a, ac = vertex(2) - a;
  const glm::dvec3 normal = glm::cross(ab, ac), size = glm::abs(normal);
  const glm::length_t r = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const glm::length_t p = (r + 1) % 3, q = (r + 2) % 3;
  // normal[r] is the area of the triangle's shadow on the other two axes; of a triangle without area all is 0 / 0.
  const double u[2] = {ac[q] / normal[r], -ac[p] / normal[r]}, v[2] = {-ab[q] / normal[r], ab[p] / normal[r]};
  const double slope[2] = {normal[p] / normal[r], normal[q] / normal[r]};
  const double numbers[9] = {
      u[0], u[1], -(u[0] * a[p] + u[1] * a[q]), v[0], v[1], -(v[0] * a[p] + v[1] * a[q]), slope[0], slope[1], -(a[r] + slope[0] * a[p] + slope[1] * a[q])};
  for (int k = 0; k < 9; ++k) map[k] = size[r] > 0 ? static_cast<float>(numbers[k]) : std::numeric_limits<float>::quiet_NaN();
  return r;
}

}  // namespace

std::size_t UnitTriangles::mem_bytes() const noexcept { return map.bytes() + axis.bytes(); }

UnitTriangles unit_triangles(const Pools& pools, int threads) {
  UnitTriangles triangles;
  triangles.map.resize(9 * pools.triangles.size());
  triangles.axis.resize(pools.triangles.size());
  const TriangleView view = pools.view().triangles;
  on_threads(threads, [&] {
    for_each_index(triangles.axis.size(), [&](std::size_t i) { triangles.axis[i] = static_cast<std::int8_t>(map_to_unit(view, i, &triangles.map[9 * i])); });
  });
  return triangles;
}

}  // namespace raymeter
