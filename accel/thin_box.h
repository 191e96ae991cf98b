#pragma once

#include "core/bounds/aabb.h"

namespace raymeter {

/// The box of a triangle or a polygon, longer by `padding` at both ends on axes where it is no longer than that; others as they are. So programs keep boxes of
/// flat things from being flat themselves: with 0.02 the counts of 1999 come out (results/reference/havran_1999_octrees.md).
[[nodiscard]] inline Aabb thickened(Aabb box, PrimKind kind, float padding) noexcept {
  if (padding == 0 || (kind != PrimKind::triangle && kind != PrimKind::polygon)) return box;
  for (glm::length_t a = 0; a < 3; ++a) {
    if (!(box.max[a] - box.min[a] <= padding)) continue;
    box.min[a] -= padding;
    box.max[a] += padding;
  }
  return box;
}

}  // namespace raymeter
