#include "experiments/verify/facet.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <set>

#include "core/geometry/error_bounds.h"

namespace raymeter::verify {

namespace {

/// The point of the edge nearest to the ray, as a share of the way from a to b.
double nearest_share(const SeenVertex& a, const SeenVertex& b) noexcept {
  const double dx = b.x - a.x, dy = b.y - a.y, length2 = dx * dx + dy * dy;
  return length2 > 0 ? std::clamp(-(a.x * dx + a.y * dy) / length2, 0.0, 1.0) : 0.0;
}

double distance(const SeenVertex& a, const SeenVertex& b) noexcept {
  const double s = nearest_share(a, b);
  return std::hypot(a.x + s * (b.x - a.x), a.y + s * (b.y - a.y));
}

using Edge = std::array<std::array<float, 3>, 2>;

Edge edge_key(const SeenVertex& a, const SeenVertex& b) { return a.position < b.position ? Edge{a.position, b.position} : Edge{b.position, a.position}; }

std::set<Edge> edge_keys(const Facet& facet) {
  std::set<Edge> keys;
  for (std::size_t k = 0; k < facet.outline.size(); ++k) keys.insert(edge_key(facet.vertex(k), facet.vertex(k + 1)));
  return keys;
}

/// Facets that share a vertex or an edge in the band belong together.
std::vector<std::vector<std::size_t>> linked(std::span<const Facet> facets) {
  std::vector<std::size_t> parent(facets.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto root = [&](std::size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  std::map<Edge, std::size_t> owner;  // a vertex is the edge from itself to itself
  for (std::size_t i = 0; i < facets.size(); ++i) {
    for (std::size_t k = 0; k < facets[i].outline.size(); ++k) {
      const SeenVertex &a = facets[i].vertex(k), &b = facets[i].vertex(k + 1);
      if (in_band(a)) parent[root(owner.try_emplace(edge_key(a, a), i).first->second)] = root(i);
      if (in_band(a, b)) parent[root(owner.try_emplace(edge_key(a, b), i).first->second)] = root(i);
    }
  }
  std::map<std::size_t, std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < facets.size(); ++i) groups[root(i)].push_back(i);
  std::vector<std::vector<std::size_t>> out;
  for (auto& [first, group] : groups) out.push_back(std::move(group));
  return out;
}

/// Whether the sum of the facets' outlines goes round the ray and keeps clear of the band. Copies of one facet count once.
bool covers(std::span<const Facet> facets, const std::vector<std::size_t>& group) {
  std::set<std::set<Edge>> seen;
  std::map<Edge, std::array<SeenVertex, 2>> odd;
  for (const std::size_t i : group) {
    if (!seen.insert(edge_keys(facets[i])).second) continue;
    for (std::size_t k = 0; k < facets[i].outline.size(); ++k) {
      const SeenVertex &a = facets[i].vertex(k), &b = facets[i].vertex(k + 1);
      const auto [edge, is_new] = odd.try_emplace(edge_key(a, b), std::array{a, b});
      if (!is_new) odd.erase(edge);
    }
  }
  std::vector<std::array<SeenVertex, 2>> curve;
  for (const auto& [key, ends] : odd) {
    if (in_band(ends[0], ends[1])) return false;
    curve.push_back(ends);
  }
  return encloses(curve);
}

}  // namespace

RaySpace::RaySpace(const Ray& ray) noexcept : org_(point(ray.org)) {
  const Point dir = point(ray.dir);
  std::size_t major = 0;
  for (std::size_t a = 1; a < 3; ++a) {
    if (std::abs(dir[a]) >= std::abs(dir[major])) major = a;
  }
  axis_ = {(major + 1) % 3, (major + 2) % 3, major};
  dir_ = dir[major];
  for (std::size_t k = 0; k < 2; ++k) slope_[k] = dir[axis_[k]] / dir_;
}

SeenVertex RaySpace::see(const std::array<float, 3>& vertex) const noexcept {
  const Point to{double{vertex[0]} - org_[0], double{vertex[1]} - org_[1], double{vertex[2]} - org_[2]};
  const double depth = to[axis_[2]];
  return {to[axis_[0]] - slope_[0] * depth,
          to[axis_[1]] - slope_[1] * depth,
          depth / dir_,
          double{kSeenVertexError} * length(to),
          {vertex[0] + 0.0f, vertex[1] + 0.0f, vertex[2] + 0.0f}};
}

bool in_band(const SeenVertex& vertex) noexcept { return std::hypot(vertex.x, vertex.y) <= vertex.band; }
bool in_band(const SeenVertex& a, const SeenVertex& b) noexcept { return distance(a, b) <= std::max(a.band, b.band); }

bool encloses(std::span<const std::array<SeenVertex, 2>> edges) noexcept {
  bool odd = false;
  for (const auto& [a, b] : edges) {
    if ((a.y <= 0) == (b.y <= 0)) continue;
    const double side = a.x * b.y - a.y * b.x;
    if ((side > 0) == (b.y > 0)) odd = !odd;
  }
  return odd;
}

Facet::Place Facet::place() const {
  std::vector<std::array<SeenVertex, 2>> edges;
  edges.reserve(outline.size());
  for (std::size_t k = 0; k < outline.size(); ++k) {
    edges.push_back({vertex(k), vertex(k + 1)});
    if (in_band(vertex(k), vertex(k + 1))) return Place::border;
  }
  return encloses(edges) ? Place::inside : Place::outside;
}

double Facet::border_depth() const noexcept {
  double nearest = std::numeric_limits<double>::infinity(), depth = 0;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const SeenVertex &a = vertex(k), &b = vertex(k + 1);
    if (const double d = distance(a, b); d < nearest) {
      nearest = d;
      depth = a.z + nearest_share(a, b) * (b.z - a.z);
    }
  }
  return depth;
}

std::vector<std::vector<std::size_t>> covering_groups(std::span<const Facet> facets) {
  std::vector<std::vector<std::size_t>> groups = linked(facets);
  std::erase_if(groups, [&](const std::vector<std::size_t>& group) { return !covers(facets, group); });
  return groups;
}

}  // namespace raymeter::verify
