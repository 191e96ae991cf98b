#include "core/bounds/obb_volume.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "core/bounds/outward_rounding.h"
#include "core/bounds/prim_hull.h"

namespace raymeter {

namespace {

using Axes = std::array<glm::dvec3, 3>;
constexpr Axes kWorld{glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)};
constexpr std::size_t kOwnAxes = 16;  ///< so many primitives at most are asked for axes of their own

double half_area_of(const glm::dvec3& half) noexcept { return 4 * (half.x * half.y + half.y * half.z + half.z * half.x); }

/// Perpendicular unit vectors: `first`'s direction, then that of `second` as far as it is across; the world's where these are none.
Axes frame(const glm::dvec3& first, const glm::dvec3& second) noexcept {
  const double length = glm::length(first);
  if (!(length > 0) || !std::isfinite(length)) return kWorld;
  const glm::dvec3 x = first / length;
  glm::dvec3 y = second - glm::dot(second, x) * x;
  if (!(glm::length(y) > 1e-9 * glm::length(second))) {
    const glm::dvec3 other = std::abs(x.x) < 0.5 ? kWorld[0] : kWorld[1];
    y = other - glm::dot(other, x) * x;
  }
  y = glm::normalize(y);
  return {x, y, glm::cross(x, y)};
}

/// Eigenvectors of a symmetric matrix by Jacobi's rotations.
Axes eigenvectors(glm::dmat3 m) noexcept {
  glm::dmat3 vectors(1.0);
  for (int sweep = 0; sweep < 12; ++sweep) {
    for (glm::length_t p = 0; p < 2; ++p) {
      for (glm::length_t q = p + 1; q < 3; ++q) {
        if (m[p][q] == 0) continue;
        const double tau = (m[q][q] - m[p][p]) / (2 * m[p][q]);
        const double t = (tau >= 0 ? 1 : -1) / (std::abs(tau) + std::hypot(1.0, tau));
        const double c = 1 / std::hypot(1.0, t), s = t * c;
        glm::dmat3 rotation(1.0);
        rotation[p][p] = rotation[q][q] = c;
        rotation[q][p] = s;
        rotation[p][q] = -s;
        m = glm::transpose(rotation) * m * rotation;
        vectors = vectors * rotation;
      }
    }
  }
  return frame(vectors[0], vectors[1]);
}

/// What the fit looks at: each primitive's hull, and what they weigh.
struct Contents {
  std::vector<PrimHull> hulls;
  glm::dvec3 middle{0.0};  ///< somewhere among them: what is summed is measured from here

  Contents() = default;
  Contents(const Scene& scene, std::span<const PrimRef> prims) {
    Aabb box;
    for (const PrimRef prim : prims) {
      hulls.push_back(prim_hull(scene.pools(), prim));
      box.grow(tight_bounds(scene.pools(), prim));
    }
    middle = (glm::dvec3(box.min) + glm::dvec3(box.max)) / 2.0;
  }

  /// Principal components of the hulls' points and discs.
  [[nodiscard]] Axes principal_axes() const noexcept {
    double weight = 0;
    glm::dvec3 mean(0.0);
    const auto each_place = [&](auto&& place) {
      for (const PrimHull& hull : hulls) {
        for (int k = 0; k < hull.point_count; ++k) place(hull.points[static_cast<std::size_t>(k)] - middle, glm::dvec3(0.0), 0.0);
        for (int k = 0; k < hull.disc_count; ++k) {
          const PrimHull::Disc& disc = hull.discs[static_cast<std::size_t>(k)];
          place(disc.center - middle, disc.normal, disc.radius);
        }
      }
    };
    each_place([&](const glm::dvec3& at, const glm::dvec3&, double) {
      weight += 1;
      mean += at;
    });
    mean /= weight;
    glm::dmat3 covariance(0.0);
    each_place([&](const glm::dvec3& at, const glm::dvec3& normal, double radius) {
      const glm::dvec3 d = at - mean;
      const double spread = radius * radius / 4;  // of a disc, along any line in it
      covariance += glm::outerProduct(d, d) + spread * (glm::dmat3(1.0) - glm::outerProduct(normal, normal));
    });
    return eigenvectors(covariance);
  }

  /// The axes of one primitive: a triangle's longest edge and another, a cone's axis.
  [[nodiscard]] static Axes own_axes(const PrimHull& hull) noexcept {
    if (hull.disc_count == 2) return frame(hull.discs[1].center - hull.discs[0].center, kWorld[0]);
    if (hull.point_count != 3) return kWorld;
    std::array<glm::dvec3, 3> edge;
    for (std::size_t k = 0; k < 3; ++k) edge[k] = hull.points[(k + 1) % 3] - hull.points[k];
    std::sort(edge.begin(), edge.end(), [](const glm::dvec3& a, const glm::dvec3& b) { return glm::dot(a, a) > glm::dot(b, b); });
    return frame(edge[0], edge[1]);
  }

  /// The box along these axes, conservative: what counts are the axes after rounding.
  [[nodiscard]] Obb box_along(const Axes& axes) const noexcept {
    Obb box;
    glm::dmat3 rows;
    glm::dvec3 low, high;
    for (glm::length_t i = 0; i < 3; ++i) {
      const glm::vec3 axis(axes[static_cast<std::size_t>(i)]);
      box.axis[static_cast<std::size_t>(i)] = axis;
      rows[i] = glm::dvec3(axis);
      low[i] = std::numeric_limits<double>::infinity();
      high[i] = -low[i];
      for (const PrimHull& hull : hulls) {
        low[i] = std::min(low[i], -hull.reach(-glm::dvec3(axis), middle));
        high[i] = std::max(high[i], hull.reach(glm::dvec3(axis), middle));
      }
    }
    box.center = glm::vec3(middle + glm::inverse(glm::transpose(rows)) * ((low + high) / 2.0));
    const glm::dvec3 moved = glm::dvec3(box.center) - middle;
    const double coordinate = std::max({std::abs(middle.x), std::abs(middle.y), std::abs(middle.z)});
    for (glm::length_t i = 0; i < 3; ++i) {
      const double shift = glm::dot(rows[i], moved);
      box.half[i] = round_up(std::max(high[i] - shift, shift - low[i]) + 0x1p-48 * coordinate);
    }
    return box;
  }
};

std::array<glm::dvec3, 8> corners(const Obb& box) noexcept {
  glm::dmat3 rows;
  for (glm::length_t i = 0; i < 3; ++i) rows[i] = glm::dvec3(box.axis[static_cast<std::size_t>(i)]);
  const glm::dmat3 from_slabs = glm::inverse(glm::transpose(rows));
  std::array<glm::dvec3, 8> out;
  for (int c = 0; c < 8; ++c) {
    const glm::dvec3 at(c & 1 ? box.half.x : -box.half.x, c & 2 ? box.half.y : -box.half.y, c & 4 ? box.half.z : -box.half.z);
    out[static_cast<std::size_t>(c)] = glm::dvec3(box.center) + from_slabs * at;
  }
  return out;
}

}  // namespace

Obb ObbVolume::fit(const Scene& scene, std::span<const PrimRef> prims) const {
  const Contents contents(scene, prims);
  std::vector<Axes> candidates;
  if (axes != ObbAxes::pca) {
    const Object* const object = scene.object_of(scene.pools().prim_id(prims.front()));
    const glm::dmat3 to_world = object != nullptr ? glm::dmat3(object->to_world) : glm::dmat3(1.0);
    candidates.push_back(frame(to_world[0], to_world[1]));
  }
  if (axes != ObbAxes::object) candidates.push_back(contents.principal_axes());
  if (axes == ObbAxes::best) {
    candidates.push_back(kWorld);
    for (std::size_t k = 0; k < contents.hulls.size() && contents.hulls.size() <= kOwnAxes; ++k) candidates.push_back(Contents::own_axes(contents.hulls[k]));
  }
  Obb best = contents.box_along(candidates.front());
  for (std::size_t k = 1; k < candidates.size(); ++k) {
    const Obb box = contents.box_along(candidates[k]);
    if (half_area(box) < half_area(best)) best = box;
  }
  return best;
}

Obb ObbVolume::merge(const Obb& a, const Obb& b) const noexcept {
  // Coincident boxes do not grow: builders rely on it where a hundred thousand objects are the same.
  if (a.center == b.center && a.axis == b.axis && a.half == b.half) return a;
  Contents contents;
  contents.middle = (glm::dvec3(a.center) + glm::dvec3(b.center)) / 2.0;
  for (const Obb* box : {&a, &b}) {
    PrimHull hull;
    hull.points = corners(*box);
    hull.point_count = 8;
    for (const glm::dvec3& corner : hull.points) {
      for (glm::length_t i = 0; i < 3; ++i) hull.margin = std::max(hull.margin, 0x1p-46 * std::abs(corner[i]));
    }
    contents.hulls.push_back(hull);
  }
  Obb best = contents.box_along(kWorld);
  for (const Obb* box : {&a, &b}) {
    const Obb along = contents.box_along({glm::dvec3(box->axis[0]), glm::dvec3(box->axis[1]), glm::dvec3(box->axis[2])});
    if (half_area(along) < half_area(best)) best = along;
  }
  return best;
}

double ObbVolume::half_area(const Obb& box) const noexcept { return half_area_of(glm::dvec3(box.half)); }

double ObbVolume::enclosed(const Obb& box) const noexcept { return 8 * double{box.half.x} * double{box.half.y} * double{box.half.z}; }

void ObbVolume::write(const Obb& box, float* data) const noexcept {
  for (glm::length_t a = 0; a < 3; ++a) {
    data[a] = box.center[a];
    for (glm::length_t i = 0; i < 3; ++i) data[3 + 3 * i + a] = box.axis[static_cast<std::size_t>(i)][a];
    data[12 + a] = box.half[a];
  }
  data[15] = round_up(double{box.half.x} + double{box.half.y} + double{box.half.z});
}

}  // namespace raymeter
