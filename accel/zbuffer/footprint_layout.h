#pragma once

#include <cstdint>

#include "core/scene/primitive.h"

namespace raymeter {

/// Coordinates on the image are half sample distances from its centre, x to the right, y downwards: sample i of N lies at 2 i - (N - 1), a whole number
/// whatever the camera's convention. Depth is the distance from the eye along the view direction.
///
/// What a primitive covers of the image, at the most: no ray kernel accepts a hit of it at a sample outside, or where 1 / depth is above `nearest`. 64 bytes.
struct alignas(64) Footprint {
  float min_x, max_x, min_y, max_y;
  float edge[3][3];  ///< a x + b y + c >= 0 inside, by (a, b, c); zeros: no such edge
  float nearest;     ///< infinite where hits may lie at the eye
  PrimRef prim;
  bool flat;  ///< its DepthPlane is that of its surface, as triangles of some size have it
};
static_assert(sizeof(Footprint) == 64);

/// Bounds 1 / depth of a primitive's hits at (x, y): x * per_x + y * per_y + at_center, or less. `nearest` at the centre where nothing better is known.
struct DepthPlane {
  float per_x;
  float per_y;
  float at_center;
};

}  // namespace raymeter
