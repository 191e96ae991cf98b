#include "core/scene/pools.h"

#include <limits>

namespace raymeter {

namespace {

std::array<const float*, 3> pointers(const FloatColumns3& columns) noexcept { return {columns[0].data(), columns[1].data(), columns[2].data()}; }

void assign(const float* (&out)[3], const FloatColumns3& columns) noexcept {
  const auto p = pointers(columns);
  for (int a = 0; a < 3; ++a) out[a] = p[static_cast<std::size_t>(a)];
}

std::size_t bytes(const FloatColumns3& columns) noexcept { return columns[0].bytes() + columns[1].bytes() + columns[2].bytes(); }

void copy3(const FloatColumns3& from, std::size_t i, FloatColumns3& to, std::size_t j) noexcept {
  for (std::size_t a = 0; a < 3; ++a) to[a][j] = from[a][i];
}

void resize3(FloatColumns3& columns, std::size_t size) {
  for (Column<float>& column : columns) column.resize(size);
}

}  // namespace

PoolsView Pools::view() const noexcept {
  PoolsView view{};
  assign(view.spheres.center, spheres.center);
  view.spheres.radius = spheres.radius.data();
  view.spheres.prim = spheres.prim.data();
  view.triangles.stride = triangles.record.empty() ? 1 : 9;
  for (std::size_t k = 0; k < 3; ++k) {
    assign(view.triangles.vertex[k], triangles.vertex[k]);
    for (std::size_t a = 0; a < 3 && !triangles.record.empty(); ++a) view.triangles.vertex[k][a] = triangles.record.data() + 3 * k + a;
  }
  view.triangles.prim = triangles.prim.data();
  assign(view.polygons.vertex, polygons.vertex);
  view.polygons.first_vertex = polygons.first_vertex.data();
  assign(view.polygons.normal, polygons.normal);
  assign(view.polygons.box_min, polygons.box_min);
  assign(view.polygons.box_max, polygons.box_max);
  view.polygons.prim = polygons.prim.data();
  assign(view.cones.base, cones.base);
  assign(view.cones.axis, cones.axis);
  for (std::size_t k = 0; k < 2; ++k) view.cones.radius[k] = cones.radius[k].data();
  assign(view.cones.box_min, cones.box_min);
  assign(view.cones.box_max, cones.box_max);
  view.cones.prim = cones.prim.data();
  return view;
}

std::size_t Pools::size(PrimKind kind) const noexcept {
  switch (kind) {
    case PrimKind::sphere: return spheres.size();
    case PrimKind::triangle: return triangles.size();
    case PrimKind::polygon: return polygons.size();
    case PrimKind::cone: return cones.size();
  }
  return 0;
}

std::int32_t Pools::prim_id(PrimRef prim) const noexcept {
  switch (prim.kind()) {
    case PrimKind::sphere: return spheres.prim[prim.index];
    case PrimKind::triangle: return triangles.prim[prim.index];
    case PrimKind::polygon: return polygons.prim[prim.index];
    case PrimKind::cone: return cones.prim[prim.index];
  }
  return -1;
}

std::size_t Pools::mem_bytes() const noexcept {
  std::size_t sum = bytes(spheres.center) + spheres.radius.bytes() + spheres.prim.bytes();
  for (const FloatColumns3& vertex : triangles.vertex) sum += bytes(vertex);
  for (const FloatColumns3& normal : triangles.normal) sum += bytes(normal);
  sum += triangles.record.bytes() + triangles.prim.bytes() + triangles.normal_index.bytes();
  sum += bytes(polygons.vertex) + polygons.first_vertex.bytes() + bytes(polygons.normal) + bytes(polygons.box_min) + bytes(polygons.box_max) +
         polygons.prim.bytes();
  sum += bytes(cones.base) + bytes(cones.axis) + cones.radius[0].bytes() + cones.radius[1].bytes() + bytes(cones.box_min) + bytes(cones.box_max) +
         cones.prim.bytes();
  return sum;
}

Pools reordered(const Pools& pools, std::span<const PrimRef> order) {
  std::array<std::size_t, kPrimKindCount> count{};
  std::size_t vertex_count = 0;
  for (const PrimRef ref : order) {
    ++count[ref.kind_bits];
    if (ref.kind() == PrimKind::polygon) {
      vertex_count += static_cast<std::size_t>(pools.polygons.first_vertex[ref.index + 1] - pools.polygons.first_vertex[ref.index]);
    }
  }
  Pools out;
  const auto of = [&](PrimKind kind) noexcept { return count[static_cast<std::size_t>(kind)]; };
  resize3(out.spheres.center, of(PrimKind::sphere));
  out.spheres.radius.resize(of(PrimKind::sphere));
  out.spheres.prim.resize(of(PrimKind::sphere));
  out.triangles.record.resize(9 * of(PrimKind::triangle));
  out.triangles.prim.resize(of(PrimKind::triangle));
  resize3(out.polygons.vertex, vertex_count);
  if (of(PrimKind::polygon) > 0) out.polygons.first_vertex.resize(of(PrimKind::polygon) + 1);
  for (FloatColumns3* columns : {&out.polygons.normal, &out.polygons.box_min, &out.polygons.box_max}) resize3(*columns, of(PrimKind::polygon));
  out.polygons.prim.resize(of(PrimKind::polygon));
  for (FloatColumns3* columns : {&out.cones.base, &out.cones.axis, &out.cones.box_min, &out.cones.box_max}) resize3(*columns, of(PrimKind::cone));
  for (Column<float>& radius : out.cones.radius) radius.resize(of(PrimKind::cone));
  out.cones.prim.resize(of(PrimKind::cone));

  std::array<std::size_t, kPrimKindCount> next{};
  std::size_t next_vertex = 0;
  for (const PrimRef ref : order) {
    const std::size_t i = ref.index;
    const std::size_t j = next[ref.kind_bits]++;
    switch (ref.kind()) {
      case PrimKind::sphere:
        copy3(pools.spheres.center, i, out.spheres.center, j);
        out.spheres.radius[j] = pools.spheres.radius[i];
        out.spheres.prim[j] = pools.spheres.prim[i];
        break;
      case PrimKind::triangle:
        for (std::size_t c = 0; c < 9; ++c) out.triangles.record[9 * j + c] = pools.triangles.vertex[c / 3][c % 3][i];
        out.triangles.prim[j] = pools.triangles.prim[i];
        break;
      case PrimKind::polygon:
        for (std::int32_t k = pools.polygons.first_vertex[i]; k < pools.polygons.first_vertex[i + 1]; ++k) {
          copy3(pools.polygons.vertex, static_cast<std::size_t>(k), out.polygons.vertex, next_vertex++);
        }
        out.polygons.first_vertex[j + 1] = static_cast<std::int32_t>(next_vertex);
        copy3(pools.polygons.normal, i, out.polygons.normal, j);
        copy3(pools.polygons.box_min, i, out.polygons.box_min, j);
        copy3(pools.polygons.box_max, i, out.polygons.box_max, j);
        out.polygons.prim[j] = pools.polygons.prim[i];
        break;
      case PrimKind::cone:
        copy3(pools.cones.base, i, out.cones.base, j);
        copy3(pools.cones.axis, i, out.cones.axis, j);
        for (std::size_t k = 0; k < 2; ++k) out.cones.radius[k][j] = pools.cones.radius[k][i];
        copy3(pools.cones.box_min, i, out.cones.box_min, j);
        copy3(pools.cones.box_max, i, out.cones.box_max, j);
        out.cones.prim[j] = pools.cones.prim[i];
        break;
    }
  }
  return out;
}

}  // namespace raymeter
