#include "accel/embree/polygon_triangles.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include <glm/vec2.hpp>

namespace raymeter {

namespace {

/// A corner of what is left of the outline.
struct Corner {
  glm::dvec2 point;      ///< seen from where the outline turns left
  std::uint32_t vertex;  ///< in the pool
};

/// Twice the area of a triangle; positive where it turns left.
double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) noexcept { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

/// The polygon's corners without the coordinate in which its normal is largest. Double holds the vertices exactly.
std::vector<Corner> corners_of(const PolygonPool& pool, std::size_t polygon) {
  std::size_t drop = 0;
  for (std::size_t a = 1; a < 3; ++a) {
    if (std::abs(pool.normal[a][polygon]) > std::abs(pool.normal[drop][polygon])) drop = a;
  }
  std::size_t x = (drop + 1) % 3, y = (drop + 2) % 3;
  if (pool.normal[drop][polygon] < 0) std::swap(x, y);
  std::vector<Corner> corners;
  for (std::int32_t v = pool.first_vertex[polygon]; v < pool.first_vertex[polygon + 1]; ++v) {
    const auto vertex = static_cast<std::uint32_t>(v);
    corners.push_back({{pool.vertex[x][vertex], pool.vertex[y][vertex]}, vertex});
  }
  return corners;
}

/// Whether a corner can be cut off: it turns left, and nothing of the outline reaches into its triangle. Corners in the same places as the triangle's are
/// where the outline meets itself, as where a hole is joined to it.
bool is_ear(std::span<const Corner> corners, std::size_t at) noexcept {
  const std::size_t count = corners.size();
  const glm::dvec2 a = corners[(at + count - 1) % count].point, b = corners[at].point, c = corners[(at + 1) % count].point;
  if (turn(a, b, c) <= 0) return false;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec2& p = corners[i].point;
    if (p == a || p == b || p == c) continue;
    if (turn(corners[(i + count - 1) % count].point, p, corners[(i + 1) % count].point) > 0) continue;  // of what is inside, a concave corner is nearest
    if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) return false;
  }
  return true;
}

/// Whether nothing is lost without a corner: it is in the place of a neighbour, or the outline turns back there. Straight corners are kept, since neighbours
/// may have theirs in the same place: between an edge and its halves rays would find a gap.
bool is_spike(std::span<const Corner> corners, std::size_t at) noexcept {
  const std::size_t count = corners.size();
  const glm::dvec2 a = corners[(at + count - 1) % count].point, b = corners[at].point, c = corners[(at + 1) % count].point;
  const glm::dvec2 before = b - a, after = c - b;
  return turn(a, b, c) == 0 && before.x * after.x + before.y * after.y <= 0;
}

void cut_ears(std::vector<Corner> corners, std::int32_t polygon, PolygonTriangles& out) {
  const auto area = [&](std::size_t at) {
    const std::size_t count = corners.size();
    return turn(corners[(at + count - 1) % count].point, corners[at].point, corners[(at + 1) % count].point);
  };
  std::size_t at = 0;
  for (std::size_t refused = 0; corners.size() >= 3;) {
    const std::size_t count = corners.size();
    at %= count;
    const bool stuck = refused >= count;  // no ear is left: the outline crosses itself
    const double doubled = area(at);
    if (!stuck && !is_spike(corners, at) && !is_ear(corners, at)) {
      ++at;
      ++refused;
      continue;
    }
    if (doubled > 0) {
      out.vertex.push_back({corners[(at + count - 1) % count].vertex, corners[at].vertex, corners[(at + 1) % count].vertex});
      out.polygon.push_back(polygon);
    }
    corners.erase(corners.begin() + static_cast<std::ptrdiff_t>(at));
    ++at;  // the next corner but one: round the outline instead of a fan of slivers
    refused = 0;
  }
}

}  // namespace

PolygonTriangles triangles_of(const PolygonPool& pool) {
  PolygonTriangles out;
  for (std::size_t polygon = 0; polygon < pool.size(); ++polygon) cut_ears(corners_of(pool, polygon), static_cast<std::int32_t>(polygon), out);
  return out;
}

}  // namespace raymeter
