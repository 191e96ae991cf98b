#include "core/bounds/kdop_volume.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "core/base/error.h"
#include "core/bounds/outward_rounding.h"
#include "core/bounds/prim_hull.h"

namespace raymeter {

namespace {

/// Directions to the faces (k = 6), corners (8) and edges (12) of a cube, one of each opposite pair.
std::vector<glm::vec3> cube_directions(int k) {
  const bool faces = k == 6 || k == 14 || k == 18 || k == 26, corners = k == 8 || k == 14 || k == 20 || k == 26;
  const bool edges = k == 12 || k == 18 || k == 20 || k == 26;
  if (!faces && !corners && !edges) throw Error("k: " + std::to_string(k) + ", expected 6, 8, 12, 14, 18, 20 or 26");
  constexpr std::array kFaces{glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)};
  constexpr std::array kCorners{glm::vec3(1, 1, 1), glm::vec3(1, 1, -1), glm::vec3(1, -1, 1), glm::vec3(1, -1, -1)};
  constexpr std::array kEdges{glm::vec3(1, 1, 0), glm::vec3(1, -1, 0), glm::vec3(1, 0, 1), glm::vec3(1, 0, -1), glm::vec3(0, 1, 1), glm::vec3(0, 1, -1)};
  std::vector<glm::vec3> directions;
  const auto add = [&](std::span<const glm::vec3> more) {
    for (const glm::vec3& direction : more) directions.push_back(direction);
  };
  if (faces) add(kFaces);
  if (corners) add(kCorners);
  if (edges) add(kEdges);
  return directions;
}

[[noreturn]] void refuse(std::string_view text, const std::string& why) {
  throw Error("directions: '" + std::string(text) + "': " + why + ", expected 3 to 13 vectors that span space, as in 1 0 0/0 1 0/0 0.6 0.8");
}

std::vector<glm::vec3> parse_directions(std::string_view text) {
  std::vector<glm::vec3> directions;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (true) {
    glm::vec3 direction(0.0f);
    for (glm::length_t a = 0; a < 3; ++a) {
      while (at != end && *at == ' ') ++at;
      const auto [next, error] = std::from_chars(at, end, direction[a]);
      if (error != std::errc{}) refuse(text, "three numbers are missing at position " + std::to_string(at - text.data()));
      at = next;
    }
    // Of about unit length, so that no product with coordinates leaves the range of floats.
    const double length = glm::length(glm::dvec3(direction));
    if (!(length > 0) || !std::isfinite(length)) refuse(text, "a direction is zero or infinite");
    directions.emplace_back(glm::dvec3(direction) / length);
    while (at != end && *at == ' ') ++at;
    if (at == end) break;
    if (*at != '/') refuse(text, "unexpected '" + std::string(1, *at) + "'");
    ++at;
  }
  if (directions.size() < 3 || directions.size() > kMaxSlabs) refuse(text, std::to_string(directions.size()) + " vectors");
  return directions;
}

/// A convex polygon in space; cutting it by a plane adds one vertex at most.
struct Face {
  std::array<glm::dvec3, 2 * kMaxSlabs + 4> vertex;
  std::size_t count = 0;

  /// Keeps what has normal . x <= limit.
  void cut(const glm::dvec3& normal, double limit) noexcept {
    std::array<double, 2 * kMaxSlabs + 4> above;
    bool cuts = false;
    for (std::size_t k = 0; k < count; ++k) {
      above[k] = glm::dot(normal, vertex[k]) - limit;
      cuts = cuts || above[k] > 0;
    }
    if (!cuts) return;
    const Face whole = *this;
    count = 0;
    for (std::size_t k = 0; k < whole.count; ++k) {
      const std::size_t next = k + 1 < whole.count ? k + 1 : 0;
      const glm::dvec3 &a = whole.vertex[k], &b = whole.vertex[next];
      if (above[k] <= 0) vertex[count++] = a;
      if (above[k] * above[next] < 0) vertex[count++] = a + (b - a) * (above[k] / (above[k] - above[next]));
    }
  }
  [[nodiscard]] double area() const noexcept {
    glm::dvec3 sum(0.0);
    for (std::size_t k = 2; k < count; ++k) sum += glm::cross(vertex[k - 1] - vertex[0], vertex[k] - vertex[0]);
    return glm::length(sum) / 2;
  }
};

}  // namespace

KdopVolume::KdopVolume(const Scene& scene, int k) : KdopVolume(scene, cube_directions(k)) {}

KdopVolume::KdopVolume(const Scene& scene, std::string_view directions) : KdopVolume(scene, parse_directions(directions)) {
  if (!(std::abs(glm::determinant(basis_)) > 1e-3)) refuse(directions, "they do not span space");
}

KdopVolume::KdopVolume(const Scene& scene, std::vector<glm::vec3> directions) : directions_(std::move(directions)) {
  Aabb box;
  for (std::int32_t id = 0; id < scene.prim_id_count(); ++id) {
    if (!scene.prim(id).dropped()) box.grow(tight_bounds(scene.pools(), scene.prim(id)));
  }
  if (!box.empty()) {
    origin_ = glm::vec3((glm::dvec3(box.min) + glm::dvec3(box.max)) / 2.0);
    // A percent more, for what hits may be off.
    radius_ = round_up(1.01 * glm::length(glm::max(glm::dvec3(box.max) - glm::dvec3(origin_), glm::dvec3(origin_) - glm::dvec3(box.min))));
  }
  basis_ = glm::dmat3(0.0);
  for (std::size_t i = 0; i < directions_.size(); ++i) {
    for (std::size_t j = i + 1; j < directions_.size(); ++j) {
      for (std::size_t k = j + 1; k < directions_.size(); ++k) {
        const glm::dmat3 rows = glm::transpose(glm::dmat3(directions_[i], directions_[j], directions_[k]));
        if (!(std::abs(glm::determinant(rows)) > std::abs(glm::determinant(basis_)))) continue;
        basis_ = rows;
        basis_slabs_ = {i, j, k};
      }
    }
  }
}

Kdop KdopVolume::fit(const Scene& scene, std::span<const PrimRef> prims) const {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  std::array<double, kMaxSlabs> least, most;
  least.fill(kInf);
  most.fill(-kInf);
  const glm::dvec3 origin(origin_);
  for (const PrimRef prim : prims) {
    const PrimHull hull = prim_hull(scene.pools(), prim);
    for (std::size_t i = 0; i < directions_.size(); ++i) {
      const glm::dvec3 direction(directions_[i]);
      least[i] = std::min(least[i], -hull.reach(-direction, origin));
      most[i] = std::max(most[i], hull.reach(direction, origin));
    }
  }
  Kdop kdop;
  for (std::size_t i = 0; i < directions_.size(); ++i) {
    kdop.min[i] = round_down(least[i]);
    kdop.max[i] = round_up(most[i]);
  }
  return kdop;
}

Kdop KdopVolume::merge(const Kdop& a, const Kdop& b) const noexcept {
  Kdop both;
  for (std::size_t i = 0; i < directions_.size(); ++i) {
    both.min[i] = std::min(a.min[i], b.min[i]);
    both.max[i] = std::max(a.max[i], b.max[i]);
  }
  return both;
}

KdopVolume::Measure KdopVolume::measure(const Kdop& kdop) const noexcept {
  // The parallelepiped of three slabs: everything is measured from its middle, and it reaches at least as far as the polytope.
  glm::dvec3 middle, half;
  for (glm::length_t a = 0; a < 3; ++a) {
    const std::size_t slab = basis_slabs_[static_cast<std::size_t>(a)];
    middle[a] = (double{kdop.max[slab]} + double{kdop.min[slab]}) / 2;
    half[a] = (double{kdop.max[slab]} - double{kdop.min[slab]}) / 2;
  }
  const glm::dmat3 from_slabs = glm::inverse(basis_);
  const glm::dvec3 center = from_slabs * middle;
  double reach = 0;
  for (glm::length_t a = 0; a < 3; ++a) reach += glm::length(from_slabs[a]) * half[a];
  std::array<glm::dvec3, 2 * kMaxSlabs> normal;
  std::array<double, 2 * kMaxSlabs> height;
  const std::size_t faces = 2 * directions_.size();
  for (std::size_t f = 0; f < faces; ++f) {
    const glm::dvec3 direction(directions_[f / 2]);
    normal[f] = f % 2 == 0 ? direction : -direction;
    height[f] = (f % 2 == 0 ? double{kdop.max[f / 2]} : -double{kdop.min[f / 2]}) - glm::dot(normal[f], center);
  }
  Measure polytope;
  for (std::size_t f = 0; f < faces; ++f) {
    const glm::dvec3 other = std::abs(normal[f].x) < std::abs(normal[f].y) ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 x = 4 * reach * glm::normalize(glm::cross(normal[f], other)), y = glm::cross(glm::normalize(normal[f]), x);
    const glm::dvec3 foot = normal[f] * (height[f] / glm::dot(normal[f], normal[f]));
    Face face;
    face.vertex = {foot - x - y, foot + x - y, foot + x + y, foot - x + y};
    face.count = 4;
    for (std::size_t g = 0; g < faces && face.count > 0; ++g) {
      if (g / 2 != f / 2) face.cut(normal[g], height[g]);
    }
    const double area = face.area();
    polytope.area += area;
    polytope.enclosed += area * height[f] / glm::length(normal[f]) / 3;  // the pyramid from the middle; outside of it heights are negative
  }
  return polytope;
}

KdopLayout::Shared KdopVolume::shared() const noexcept {
  KdopLayout::Shared slabs{};
  slabs.count = static_cast<std::int32_t>(directions_.size());
  for (std::size_t i = 0; i < directions_.size(); ++i) {
    for (glm::length_t a = 0; a < 3; ++a) slabs.direction[i][a] = directions_[i][a];
    slabs.length[i] = round_up(glm::length(glm::dvec3(directions_[i])) * (1 + 0x1p-48));
  }
  for (glm::length_t a = 0; a < 3; ++a) slabs.origin[a] = origin_[a];
  slabs.radius = radius_;
  return slabs;
}

void KdopVolume::write(const Kdop& kdop, float* data) const noexcept {
  for (std::size_t i = 0; i < directions_.size(); ++i) {
    data[2 * i] = kdop.min[i];
    data[2 * i + 1] = kdop.max[i];
  }
}

}  // namespace raymeter
