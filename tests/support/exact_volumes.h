#pragma once

// Points of surfaces, and whether bounding volumes hold them, in rationals.

#include <cmath>

#include <gmpxx.h>

#include "core/bounds/aabb_volume.h"
#include "core/bounds/kdop_volume.h"
#include "core/bounds/obb_volume.h"
#include "core/bounds/sphere_volume.h"
#include "core/geometry/error_bounds.h"
#include "tests/support/random.h"

namespace raymeter::test {

using Exact = std::array<mpq_class, 3>;

inline Exact exact(const glm::dvec3& p) { return {p.x, p.y, p.z}; }
inline Exact operator-(const Exact& a, const Exact& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Exact operator+(const Exact& a, const Exact& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Exact operator*(const mpq_class& s, const Exact& a) { return {s * a[0], s * a[1], s * a[2]}; }
inline mpq_class dot(const Exact& a, const Exact& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Exact cross(const Exact& a, const Exact& b) { return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}; }

inline bool holds(const AabbVolume&, const Aabb& box, const Exact& p) {
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<glm::length_t>(a);
    if (p[a] < double{box.min[axis]} || p[a] > double{box.max[axis]}) return false;
  }
  return true;
}
inline bool holds(const SphereVolume&, const BoundingSphere& sphere, const Exact& p) {
  const Exact d = p - exact(glm::dvec3(sphere.center));
  const mpq_class radius(double{sphere.radius});
  return dot(d, d) <= radius * radius;
}
inline bool holds(const ObbVolume&, const Obb& box, const Exact& p) {
  const Exact d = p - exact(glm::dvec3(box.center));
  for (std::size_t i = 0; i < 3; ++i) {
    const mpq_class half(double{box.half[static_cast<glm::length_t>(i)]});
    if (abs(dot(exact(glm::dvec3(box.axis[i])), d)) > half) return false;
  }
  return true;
}
inline bool holds(const KdopVolume& volume, const Kdop& kdop, const Exact& p) {
  const Exact d = p - exact(glm::dvec3(volume.origin()));
  for (std::size_t i = 0; i < volume.directions().size(); ++i) {
    const mpq_class at = dot(exact(glm::dvec3(volume.directions()[i])), d);
    if (at < double{kdop.min[i]} || at > double{kdop.max[i]}) return false;
  }
  return true;
}

/// A rational vector along v, no longer than 1 and shorter by at most 1e-12.
inline Exact almost_unit(const Exact& v) {
  const mpq_class length2 = dot(v, v);
  mpq_class scale(1 / std::sqrt(length2.get_d()));
  while (scale * scale * length2 > 1) scale *= mpq_class(1 - 0x1p-44);
  return scale * v;
}

/// A point of the surface, or inside of it by 1e-12 of its size at most.
inline Exact surface_point(const Pools& pools, PrimRef ref, Random& random) {
  const std::size_t i = ref.index;
  const auto at = [](const FloatColumns3& columns, std::size_t k) { return exact(glm::dvec3(columns[0][k], columns[1][k], columns[2][k])); };
  switch (ref.kind()) {
    case PrimKind::sphere: return at(pools.spheres.center, i) + mpq_class(double{pools.spheres.radius[i]}) * almost_unit(exact(random.direction()));
    case PrimKind::triangle: {
      const mpq_class u(random.uniform()), v(random.uniform() * (1 - u.get_d()));
      const Exact a = at(pools.triangles.vertex[0], i), b = at(pools.triangles.vertex[1], i), c = at(pools.triangles.vertex[2], i);
      switch (random.below(4)) {
        case 0: return a;
        case 1: return b;
        case 2: return c;
        default: return a + u * (b - a) + v * (c - a);
      }
    }
    case PrimKind::polygon: {
      const auto first = static_cast<std::size_t>(pools.polygons.first_vertex[i]), end = static_cast<std::size_t>(pools.polygons.first_vertex[i + 1]);
      return at(pools.polygons.vertex, first + random.below(end - first));
    }
    case PrimKind::cone: {
      const Exact axis = at(pools.cones.axis, i);
      Exact across = cross(axis, exact(random.direction()));
      if (dot(across, across) == 0) across = exact(random.direction());
      const mpq_class y(random.below(3) == 0 ? 0.0 : random.below(2) == 0 ? 1.0 : random.uniform());
      const mpq_class radius = (1 - y) * double{pools.cones.radius[0][i]} + y * double{pools.cones.radius[1][i]};
      return at(pools.cones.base, i) + y * axis + radius * almost_unit(across);
    }
  }
  return {};
}

/// How far a hit may be off, as far as that is relative to the primitive's size: for boxes per axis, else in any direction (error_bounds.h). A little less, for
/// the roundings here.
inline Exact error_for(const AabbVolume&, const Aabb& box, Random& random) {
  const double extent = double{std::max({box.extent().x, box.extent().y, box.extent().z})};
  return exact(random.in_cube(double{kPrimitiveError} * extent * 0.999));
}
template <class V>
Exact error_for(const V&, const Aabb& box, Random& random) {
  return exact(double{kSurfaceError} * glm::length(glm::dvec3(box.extent())) * 0.999 * random.direction());
}

}  // namespace raymeter::test
