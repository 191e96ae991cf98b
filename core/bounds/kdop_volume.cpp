#include "core/bounds/kdop_volume.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>

#include <glm/geometric.hpp>

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

}  // namespace

KdopVolume::KdopVolume(const Scene& scene, int k) : KdopVolume(scene, cube_directions(k)) {}

KdopVolume::KdopVolume(const Scene& scene, std::string_view directions) : KdopVolume(scene, parse_directions(directions)) {
  if (!polytope_.spans_space()) refuse(directions, "they do not span space");
}

KdopVolume::KdopVolume(const Scene& scene, std::vector<glm::vec3> directions) : directions_(std::move(directions)), polytope_(directions_) {
  Aabb box;
  for (std::int32_t id = 0; id < scene.prim_id_count(); ++id) {
    if (!scene.prim(id).dropped()) box.grow(tight_bounds(scene.pools(), scene.prim(id)));
  }
  if (!box.empty()) {
    origin_ = glm::vec3((glm::dvec3(box.min) + glm::dvec3(box.max)) / 2.0);
    // A percent more, for what hits may be off.
    radius_ = round_up(1.01 * glm::length(glm::max(glm::dvec3(box.max) - glm::dvec3(origin_), glm::dvec3(origin_) - glm::dvec3(box.min))));
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

KdopLayout::Shared KdopVolume::shared(std::span<const Kdop>) const noexcept {
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
