#include "core/bounds/aabb.h"

#include <cmath>

#include "core/bounds/outward_rounding.h"
#include "core/geometry/error_bounds.h"

namespace raymeter {

namespace {

/// A disc of radius r with unit normal n reaches r sqrt(1 - n_a^2) along axis a; a cone is the hull of its two rims.
Aabb cone_bounds(const ConePool& cones, std::size_t i) noexcept {
  double axis[3], length2 = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    axis[a] = double{cones.axis[a][i]};
    length2 += axis[a] * axis[a];
  }
  Aabb box;
  for (std::size_t a = 0; a < 3; ++a) {
    // The sum of the other squares, not 1 - n_a^2, which cancels. Grown by a few double roundings, so that rounding outwards to float is enough.
    const double across2 = axis[(a + 1) % 3] * axis[(a + 1) % 3] + axis[(a + 2) % 3] * axis[(a + 2) % 3];
    const double reach = (length2 > 0 ? std::sqrt(across2 / length2) : 1.0) * (1 + 0x1p-48);
    const double base = double{cones.base[a][i]};
    const double apex = base + axis[a];
    const double slack = 0x1p-50 * (std::abs(base) + std::abs(axis[a]));
    const double r0 = double{cones.radius[0][i]} * reach + slack;
    const double r1 = double{cones.radius[1][i]} * reach + slack;
    const auto axis_index = static_cast<glm::length_t>(a);
    box.min[axis_index] = round_down(std::min(base - r0, apex - r1));
    box.max[axis_index] = round_up(std::max(base + r0, apex + r1));
  }
  return box;
}

}  // namespace

Aabb tight_bounds(const Pools& pools, PrimRef ref) noexcept {
  Aabb box;
  const std::size_t i = ref.index;
  const auto point = [](const FloatColumns3& columns, std::size_t k) noexcept { return glm::vec3(columns[0][k], columns[1][k], columns[2][k]); };
  switch (ref.kind()) {
    case PrimKind::sphere:
      for (glm::length_t a = 0; a < 3; ++a) {
        const double center = double{pools.spheres.center[static_cast<std::size_t>(a)][i]};
        box.min[a] = round_down(center - double{pools.spheres.radius[i]});
        box.max[a] = round_up(center + double{pools.spheres.radius[i]});
      }
      break;
    case PrimKind::triangle:
      for (const FloatColumns3& vertex : pools.triangles.vertex) box.grow(point(vertex, i));
      break;
    case PrimKind::polygon:
      for (auto k = static_cast<std::size_t>(pools.polygons.first_vertex[i]); k < static_cast<std::size_t>(pools.polygons.first_vertex[i + 1]); ++k) {
        box.grow(point(pools.polygons.vertex, k));
      }
      break;
    case PrimKind::cone: return cone_bounds(pools.cones, i);
  }
  return box;
}

Aabb padded(const Aabb& box) noexcept {
  const double x = double{box.max.x} - double{box.min.x}, y = double{box.max.y} - double{box.min.y}, z = double{box.max.z} - double{box.min.z};
  const double largest_extent = std::max(std::max(x, y), z);
  Aabb out;
  for (glm::length_t a = 0; a < 3; ++a) {
    const double low{box.min[a]}, high{box.max[a]};
    const double padding = double{kBoundsPadding} * std::max(std::max(largest_extent, std::abs(low)), std::abs(high));
    out.min[a] = round_down(low - padding);
    out.max[a] = round_up(high + padding);
  }
  return out;
}

}  // namespace raymeter
