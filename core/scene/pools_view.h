#pragma once

#include <cstdint>

namespace raymeter {

// Pointers into the primitive pools of a scene, or into a structure's own copy of them in leaf order. `prim` is the primitive's id.

struct SphereView {
  const float* center[3];
  const float* radius;
  const std::int32_t* prim;
};

/// Coordinate `axis` of vertex k of triangle i is vertex[k][axis][i * stride]: columns have stride 1, records of nine floats stride 9.
struct TriangleView {
  const float* vertex[3][3];
  std::int32_t stride;
  const std::int32_t* prim;
};

/// Polygon i has the vertices [first_vertex[i], first_vertex[i + 1]) of the vertex columns; they may form a concave outline.
struct PolygonView {
  const float* vertex[3];
  const std::int32_t* first_vertex;
  const float* normal[3];  ///< not normalised
  const float* box_min[3];
  const float* box_max[3];
  const std::int32_t* prim;
};

/// Open cones from `base` with radius[0] to base + axis with radius[1].
struct ConeView {
  const float* base[3];
  const float* axis[3];
  const float* radius[2];
  const float* box_min[3];
  const float* box_max[3];
  const std::int32_t* prim;
};

struct PoolsView {
  SphereView spheres;
  TriangleView triangles;
  PolygonView polygons;
  ConeView cones;
};

}  // namespace raymeter
