#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/column.h"
#include "core/geometry/primitive_run.h"
#include "core/scene/pools_view.h"
#include "core/scene/primitive.h"

namespace raymeter {

using FloatColumns3 = std::array<Column<float>, 3>;

struct SpherePool {
  FloatColumns3 center;
  Column<float> radius;
  Column<std::int32_t> prim;
  [[nodiscard]] std::size_t size() const noexcept { return prim.size(); }
};

struct TrianglePool {
  std::array<FloatColumns3, 3> vertex;  ///< [vertex][axis]; empty where `record` is used instead
  /// Nine floats a triangle, for copies in leaf order: a leaf's triangles are read all at once, and so from few cache lines.
  Column<float> record;
  Column<std::int32_t> prim;
  /// Index of a triangle's vertex normals in `normal`, -1 where it has none; the column is empty where no triangle has any.
  Column<std::int32_t> normal_index;
  std::array<FloatColumns3, 3> normal;  ///< [vertex][axis]
  [[nodiscard]] std::size_t size() const noexcept { return prim.size(); }
};

struct PolygonPool {
  FloatColumns3 vertex;
  Column<std::int32_t> first_vertex;  ///< one more than polygons: the last is the end
  FloatColumns3 normal;               ///< Newell's, not normalised
  FloatColumns3 box_min;              ///< tight_bounds()
  FloatColumns3 box_max;
  Column<std::int32_t> prim;
  [[nodiscard]] std::size_t size() const noexcept { return prim.size(); }
};

struct ConePool {
  FloatColumns3 base;
  FloatColumns3 axis;                   ///< apex - base
  std::array<Column<float>, 2> radius;  ///< base, apex
  FloatColumns3 box_min;                ///< tight_bounds()
  FloatColumns3 box_max;
  Column<std::int32_t> prim;
  [[nodiscard]] std::size_t size() const noexcept { return prim.size(); }
};

/// One structure of arrays per primitive kind. Columns of a kind that no primitive uses take no memory.
struct Pools {
  SpherePool spheres;
  TrianglePool triangles;
  PolygonPool polygons;
  ConePool cones;

  [[nodiscard]] PoolsView view() const noexcept;
  [[nodiscard]] std::size_t size(PrimKind kind) const noexcept;
  /// The id of a primitive.
  [[nodiscard]] std::int32_t prim_id(PrimRef prim) const noexcept;
  [[nodiscard]] std::size_t mem_bytes() const noexcept;
};

/// A copy of the pools' primitives in the given order, without shading data and with triangles as records: what a leaf refers to then lies together. An entry
/// may occur several times. `pools` has columns, as a scene's has.
[[nodiscard]] Pools reordered(const Pools& pools, std::span<const PrimRef> order);

}  // namespace raymeter
