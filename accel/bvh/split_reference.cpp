#include "accel/bvh/split_reference.h"

#include <cmath>
#include <limits>

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

}  // namespace

CutReference cut(const Pools& pools, const SplitReference& reference, int axis, float position) noexcept {
  CutReference sides{reference.box, reference.box};
  sides.left.max[axis] = std::min(sides.left.max[axis], position);
  sides.right.min[axis] = std::max(sides.right.min[axis], position);
  if (reference.ref.kind() == PrimKind::triangle) {
    CutReference triangle;
    glm::vec3 corner[3];
    for (std::size_t v = 0; v < 3; ++v) {
      const FloatColumns3& vertex = pools.triangles.vertex[v];
      corner[v] = {vertex[0][reference.ref.index], vertex[1][reference.ref.index], vertex[2][reference.ref.index]};
    }
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
