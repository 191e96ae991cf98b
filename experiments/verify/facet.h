#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "experiments/verify/true_hits.h"

namespace raymeter::verify {

/// A vertex of a triangle or polygon as a ray sees it: x, y across the ray at the vertex's depth (0, 0: the ray meets it), z its depth in units of t.
/// A kernel may see it up to `band` away from there, but sees the same in all facets that share it.
struct SeenVertex {
  double x, y, z;
  double band;
  std::array<float, 3> position;  ///< with +0 for -0: vertices are shared where this is equal
};

/// The view along one ray.
class RaySpace {
public:
  explicit RaySpace(const Ray& ray) noexcept;
  [[nodiscard]] SeenVertex see(const std::array<float, 3>& vertex) const noexcept;

private:
  std::array<std::size_t, 3> axis_;  ///< the last is that of the largest |dir|
  Point org_;
  double slope_[2];
  double dir_;
};

/// Whether some ray within the band passes through the edge a b.
[[nodiscard]] bool in_band(const SeenVertex& a, const SeenVertex& b) noexcept;
[[nodiscard]] bool in_band(const SeenVertex& vertex) noexcept;
/// Whether the ray passes through the closed curve's inside by crossing parity. Means something only where no edge is in the band.
[[nodiscard]] bool encloses(std::span<const std::array<SeenVertex, 2>> edges) noexcept;

/// A triangle or polygon near the ray.
struct Facet {
  enum class Place { outside, border, inside };

  std::int32_t prim;
  std::vector<SeenVertex> outline;

  [[nodiscard]] const SeenVertex& vertex(std::size_t k) const noexcept { return outline[k % outline.size()]; }
  /// border: a ray within the band passes through the outline.
  [[nodiscard]] Place place() const;
  /// Depth of the outline's point that is nearest to the ray.
  [[nodiscard]] double border_depth() const noexcept;
};

/// Groups of the given border facets such that any kernel that sees each vertex within its band, and alike in all facets, hits a facet of each group.
/// The facets of a group hang together by vertices and edges in the band. Summed up modulo 2, their outlines leave a curve; where that keeps clear of the band
/// and goes round the ray, it does so for all rays in the band, and by the degree of the map one of the facets covers it. At a silhouette or at a border of
/// the surface there is no such group: there a hit may be lost.
[[nodiscard]] std::vector<std::vector<std::size_t>> covering_groups(std::span<const Facet> facets);

}  // namespace raymeter::verify
