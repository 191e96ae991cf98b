#include "core/bounds/split_reference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/bounds/outward_rounding.h"

namespace raymeter {

namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

Aabb intersection(const Aabb& a, const Aabb& b) noexcept {
  const Aabb box{glm::max(a.min, b.min), glm::min(a.max, b.max)};
  return glm::all(glm::lessThanEqual(box.min, box.max)) ? box : Aabb();
}

/// Where the edge from a to b, one end on each side, meets the plane: a box of a few ulps that surely holds the point.
Aabb crossing(const glm::vec3& a, const glm::vec3& b, int axis, float position) noexcept {
  const double share = (double{position} - double{a[axis]}) / (double{b[axis]} - double{a[axis]});
  Aabb box;
  for (glm::length_t k = 0; k < 3; ++k) {
    const double x = double{a[k]} + share * (double{b[k]} - double{a[k]});
    // Double errs by 2^-50 of the coordinates at most; stepping a float outwards covers that but where they cancel.
    const double slack = 0x1p-48 * (std::abs(double{a[k]}) + std::abs(double{b[k]}));
    box.min[k] = std::nextafterf(static_cast<float>(x - slack), -kInf);
    box.max[k] = std::nextafterf(static_cast<float>(x + slack), kInf);
  }
  box.min[axis] = box.max[axis] = position;
  return box;
}

glm::vec3 corner_of(const TrianglePool& triangles, PrimRef ref, std::size_t v) noexcept {
  const FloatColumns3& vertex = triangles.vertex[v];
  return {vertex[0][ref.index], vertex[1][ref.index], vertex[2][ref.index]};
}

/// A triangle on its way through the planes of a box (Sutherland, Hodgman 1974).
class Outline {
public:
  void add(const glm::dvec3& point, bool exact) noexcept { points_[count_++] = {point, exact}; }

  /// Keeps what is not beyond the plane. The capacity is enough for a convex outline, to whose corners a plane adds one; rounding may bend one a little, and
  /// what then finds no place is reported by false.
  [[nodiscard]] bool keep(glm::length_t axis, double side, double plane) noexcept {
    const auto beyond = [&](const glm::dvec3& point) noexcept { return side * (point[axis] - plane) > 0; };
    const Outline from = *this;
    count_ = 0;
    for (std::size_t i = 0; i < from.count_; ++i) {
      const Corner &a = from.points_[i], &b = from.points_[(i + 1) % from.count_];
      if (count_ + 2 > points_.size()) return false;
      if (!beyond(a.point)) points_[count_++] = a;
      if (beyond(a.point) == beyond(b.point)) continue;
      const double share = (plane - a.point[axis]) / (b.point[axis] - a.point[axis]);
      glm::dvec3 point = a.point + share * (b.point - a.point);
      point[axis] = plane;
      add(point, false);
    }
    return true;
  }

  /// Around the corners, those that were computed with `slack` on all sides.
  [[nodiscard]] Aabb bounds(double slack) const noexcept {
    Aabb box;
    for (std::size_t i = 0; i < count_; ++i) {
      for (glm::length_t a = 0; a < 3; ++a) {
        const double around = points_[i].exact ? 0 : slack;
        box.min[a] = std::min(box.min[a], round_down(points_[i].point[a] - around));
        box.max[a] = std::max(box.max[a], round_up(points_[i].point[a] + around));
      }
    }
    return box;
  }

private:
  struct Corner {
    glm::dvec3 point;
    bool exact = true;
  };
  std::array<Corner, 16> points_;
  std::size_t count_ = 0;
};

}  // namespace

Aabb clipped(const Pools& pools, PrimRef triangle, const Aabb& box) noexcept {
  Outline outline;
  Aabb whole;
  for (std::size_t v = 0; v < 3; ++v) {
    const glm::vec3 corner = corner_of(pools.triangles, triangle, v);
    whole.grow(corner);
    outline.add(glm::dvec3(corner), true);
  }
  // Six interpolations in double err by less than 2^-48 of the largest coordinate. The planes stand that much further out, so that no part is lost.
  const glm::vec3 largest = glm::max(glm::abs(whole.min), glm::abs(whole.max));
  const double slack = 0x1p-46 * double{std::max({largest.x, largest.y, largest.z})};
  for (glm::length_t a = 0; a < 3; ++a) {
    if (whole.min[a] < box.min[a] && !outline.keep(a, -1, double{box.min[a]} - slack)) return box;
    if (whole.max[a] > box.max[a] && !outline.keep(a, 1, double{box.max[a]} + slack)) return box;
  }
  return intersection(box, outline.bounds(slack));
}

CutReference cut(const Pools& pools, const SplitReference& reference, int axis, float position) noexcept {
  CutReference sides{reference.box, reference.box};
  sides.left.max[axis] = std::min(sides.left.max[axis], position);
  sides.right.min[axis] = std::max(sides.right.min[axis], position);
  if (reference.ref.kind() == PrimKind::triangle) {
    CutReference triangle;
    glm::vec3 corner[3];
    for (std::size_t v = 0; v < 3; ++v) corner[v] = corner_of(pools.triangles, reference.ref, v);
    for (int v = 0; v < 3; ++v) {
      const glm::vec3 &a = corner[v], &b = corner[(v + 1) % 3];
      if (a[axis] <= position) triangle.left.grow(a);
      if (a[axis] >= position) triangle.right.grow(a);
      if (!((a[axis] < position && b[axis] > position) || (a[axis] > position && b[axis] < position))) continue;
      const Aabb point = crossing(a, b, axis, position);
      triangle.left.grow(point);
      triangle.right.grow(point);
    }
    sides = {intersection(sides.left, triangle.left), intersection(sides.right, triangle.right)};
  }
  if (!(sides.left.min[axis] <= sides.left.max[axis])) sides.left = {};
  if (!(sides.right.min[axis] <= sides.right.max[axis])) sides.right = {};
  return sides;
}

Aabb padded_part(const Pools& pools, const SplitReference& reference) noexcept {
  const Aabb whole = tight_bounds(pools, reference.ref), padded_whole = padded(whole);
  Aabb box = reference.box;
  for (glm::length_t a = 0; a < 3; ++a) {
    const double below = double{whole.min[a]} - double{padded_whole.min[a]}, above = double{padded_whole.max[a]} - double{whole.max[a]};
    // Rounding to float may take an ulp, the step outwards gives it back.
    box.min[a] = std::nextafterf(static_cast<float>(double{box.min[a]} - below), -kInf);
    box.max[a] = std::nextafterf(static_cast<float>(double{box.max[a]} + above), kInf);
  }
  return {glm::max(box.min, padded_whole.min), glm::min(box.max, padded_whole.max)};
}

}  // namespace raymeter
