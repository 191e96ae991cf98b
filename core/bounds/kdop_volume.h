#pragma once

#include <array>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

#include "core/bounds/bounding_volume.h"
#include "core/bounds/kdop_polytope.h"

namespace raymeter {

inline constexpr std::size_t kMaxSlabs = KdopLayout::kMaxSlabs;

/// Slab i is min[i] <= N_i . (x - origin) <= max[i]; those beyond the number of directions are not used.
struct Kdop {
  std::array<float, kMaxSlabs> min{};
  std::array<float, kMaxSlabs> max{};
  bool operator==(const Kdop&) const = default;
};

/// Bounding slabs over directions that all objects share (Kay, Kajiya 1986; k-DOPs: Klosowski et al. 1998).
class KdopVolume {
public:
  using Bound = Kdop;
  using Layout = KdopLayout;
  static constexpr bool kMergeIsTight = true;

  /// The usual sets, k = 6 8 12 14 18 20 26: axes, the four diagonals of a cube, the six of its faces, and their unions. Throws Error for another k.
  KdopVolume(const Scene& scene, int k);
  /// The user's own, 3 to 13 that span space, e.g. "1 0 0/0 1 0/0 0.6 0.8"; else throws Error.
  KdopVolume(const Scene& scene, std::string_view directions);

  [[nodiscard]] Kdop fit(const Scene& scene, PrimRef prim) const { return fit(scene, {&prim, 1}); }
  [[nodiscard]] Kdop fit(const Scene& scene, std::span<const PrimRef> prims) const;
  [[nodiscard]] Kdop merge(const Kdop& a, const Kdop& b) const noexcept;
  /// Of the polytope that the slabs cut out.
  [[nodiscard]] double half_area(const Kdop& kdop) const noexcept { return polytope_.measure(kdop.min, kdop.max).area / 2; }
  [[nodiscard]] double enclosed(const Kdop& kdop) const noexcept { return polytope_.measure(kdop.min, kdop.max).enclosed; }

  [[nodiscard]] std::int32_t floats() const noexcept { return 2 * static_cast<std::int32_t>(directions_.size()); }
  [[nodiscard]] Layout::Shared shared(std::span<const Kdop>) const noexcept;
  void write(const Kdop& kdop, float* data) const noexcept;

  [[nodiscard]] std::span<const glm::vec3> directions() const noexcept { return directions_; }
  /// Slabs are measured from here, the middle of the scene: far from it N . x would have no room for a small object.
  [[nodiscard]] const glm::vec3& origin() const noexcept { return origin_; }

private:
  KdopVolume(const Scene& scene, std::vector<glm::vec3> directions);

  std::vector<glm::vec3> directions_;
  KdopPolytope polytope_;
  glm::vec3 origin_{0.0f};
  float radius_ = 0;  ///< of all that can be hit, from the origin
};
static_assert(BoundingVolume<KdopVolume>);

}  // namespace raymeter
