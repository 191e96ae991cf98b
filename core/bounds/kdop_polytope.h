#pragma once

#include <array>
#include <span>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "core/bounds/volume_layout.h"

namespace raymeter {

/// Measures the polytopes that slabs over fixed directions cut out. Builders ask for the area of every volume they might make, so all that depends on the
/// directions alone is found once: each face is then a polygon in two coordinates of its own, clipped by the planes of the other slabs.
class KdopPolytope {
public:
  struct Measure {
    double area = 0;
    double enclosed = 0;
  };

  explicit KdopPolytope(std::span<const glm::vec3> directions);

  /// Whether the directions span space, and not just barely. If not, nothing can be measured.
  [[nodiscard]] bool spans_space() const noexcept;

  /// Of all x with min[i] <= N_i . x <= max[i].
  [[nodiscard]] Measure measure(std::span<const float> min, std::span<const float> max) const noexcept;

private:
  using Limits = std::array<double, KdopLayout::kMaxSlabs>;

  /// A slab as seen in the plane of a face N_i . x = d: min <= x u + y v + along d <= max for the point (u, v).
  struct Trace {
    double x = 0, y = 0, along = 0;
  };
  /// Both faces of a slab.
  struct Plane {
    double length = 0;                        ///< of the direction
    std::array<std::size_t, 2> edge_slabs{};  ///< the two others whose parallelogram in it is least for one width: clipping starts there
    std::array<double, 4> to_point{};         ///< from values of those two to (u, v), by rows
  };

  void choose_edges(std::size_t face);
  [[nodiscard]] double face_area(std::size_t face, double height, const Limits& low, const Limits& high) const noexcept;
  [[nodiscard]] const Trace& trace(std::size_t face, std::size_t slab) const noexcept { return traces_[face * planes_.size() + slab]; }

  std::vector<glm::dvec3> directions_;
  std::vector<Plane> planes_;
  std::vector<Trace> traces_;
  std::array<std::size_t, 3> basis_slabs_{};  ///< three that enclose as little as any three of one width
  double determinant_ = 0;                    ///< of their directions
  glm::dmat3 from_basis_{0.0};                ///< from values of theirs to a point
};

}  // namespace raymeter
