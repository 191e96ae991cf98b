#include "core/scene/scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include "core/bounds/aabb.h"

namespace raymeter {

namespace {

bool in_range(double x) noexcept { return std::abs(x) <= Scene::kLargestCoordinate; }
bool in_range(const glm::dvec3& p) noexcept { return in_range(p.x) && in_range(p.y) && in_range(p.z); }
bool valid_radius(double r) noexcept { return r >= 0 && in_range(r); }

void push(FloatColumns3& columns, const glm::dvec3& p) {
  for (std::size_t a = 0; a < 3; ++a) columns[a].push_back(static_cast<float>(p[static_cast<glm::length_t>(a)]));
}

glm::dvec3 rounded(const glm::dvec3& p) noexcept { return glm::dvec3(glm::vec3(p)); }

/// a - b, where that is exact.
std::optional<glm::dvec3> exact_difference(const glm::dvec3& a, const glm::dvec3& b) noexcept {
  const glm::dvec3 d = a - b, part = d - a;
  const glm::dvec3 lost = (a - (d - part)) - (b + part);  // TwoSum
  return lost == glm::dvec3(0.0) ? std::optional(d) : std::nullopt;
}

/// Whether the rounded vertices lie on a line, exactly. Where doubles cannot tell, they do not.
bool collinear(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) noexcept {
  const auto ab = exact_difference(rounded(b), rounded(a)), ac = exact_difference(rounded(c), rounded(a));
  if (!ab || !ac) return false;
  for (glm::length_t i = 0; i < 3; ++i) {
    const glm::length_t j = (i + 1) % 3;
    const double p = (*ab)[i] * (*ac)[j], q = (*ab)[j] * (*ac)[i];
    if (p != q || std::fma((*ab)[i], (*ac)[j], -p) != std::fma((*ab)[j], (*ac)[i], -q)) return false;
  }
  return true;
}

/// Of vertices on a line, the middle one moved to an end: with two vertices in one place kernels see no area, whatever they round.
std::array<glm::dvec3, 3> segment(std::array<glm::dvec3, 3> vertex) noexcept {
  const auto between = [](const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& r) {
    const glm::dvec3 low = glm::min(p, r), high = glm::max(p, r);
    return glm::all(glm::lessThanEqual(low, q)) && glm::all(glm::lessThanEqual(q, high));
  };
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 &before = vertex[(k + 2) % 3], &after = vertex[(k + 1) % 3];
    if (!between(before, vertex[k], after)) continue;
    vertex[k] = after;
    break;
  }
  return vertex;
}

void reserve3(FloatColumns3& columns, std::size_t count) {
  for (Column<float>& column : columns) column.reserve(count);
}

void shrink3(FloatColumns3& columns) {
  for (Column<float>& column : columns) column.shrink_to_fit();
}

}  // namespace

void Scene::drop() {
  prims_.push_back({PrimRef::kDropped, 0});
  ++dropped_;
}

void Scene::add_prim(PrimKind kind, std::size_t index) { prims_.push_back(prim_ref(kind, index)); }

void Scene::add_sphere(glm::dvec3 center, double radius) {
  if (!in_range(center) || !valid_radius(radius)) return drop();
  SpherePool& pool = pools_.spheres;
  pool.prim.push_back(prim_id_count());
  push(pool.center, center);
  pool.radius.push_back(static_cast<float>(radius));
  add_prim(PrimKind::sphere, pool.size() - 1);
}

void Scene::add_triangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  if (!in_range(a) || !in_range(b) || !in_range(c)) return drop();
  TrianglePool& pool = pools_.triangles;
  pool.prim.push_back(prim_id_count());
  const std::array<glm::dvec3, 3> vertex = collinear(a, b, c) ? segment({a, b, c}) : std::array{a, b, c};
  for (std::size_t k = 0; k < 3; ++k) push(pool.vertex[k], vertex[k]);
  if (!pool.normal_index.empty()) pool.normal_index.push_back(-1);
  add_prim(PrimKind::triangle, pool.size() - 1);
}

void Scene::add_triangle(const std::array<glm::dvec3, 3>& vertex, const std::array<glm::dvec3, 3>& normal) {
  const std::int32_t dropped_before = dropped_;
  add_triangle(vertex[0], vertex[1], vertex[2]);
  const bool usable = std::all_of(normal.begin(), normal.end(), [](const glm::dvec3& n) { return in_range(n) && glm::dot(n, n) > 0; });
  if (dropped_ != dropped_before || !usable) return;
  TrianglePool& pool = pools_.triangles;
  pool.normal_index.resize(pool.size(), -1);
  pool.normal_index.back() = static_cast<std::int32_t>(pool.normal[0][0].size());
  for (std::size_t k = 0; k < 3; ++k) push(pool.normal[k], normal[k]);
}

void Scene::add_polygon(std::span<const glm::dvec3> vertices) {
  if (vertices.size() < 3 || !std::all_of(vertices.begin(), vertices.end(), [](const glm::dvec3& v) { return in_range(v); })) return drop();
  PolygonPool& pool = pools_.polygons;
  if (pool.first_vertex.empty()) pool.first_vertex.push_back(0);
  const glm::dvec3 origin = rounded(vertices[0]);
  glm::dvec3 normal(0.0);  // Newell's, about vertex 0: every vertex counts, so that a short first edge does not spoil it
  Aabb box;
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const glm::dvec3 p = rounded(vertices[k]);
    normal += glm::cross(p - origin, rounded(vertices[(k + 1) % vertices.size()]) - origin);
    box.grow(glm::vec3(p));
    push(pool.vertex, p);
  }
  const double largest = std::max({std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)});
  if (largest > 0) normal /= largest;  // only its direction matters; its length could underflow
  push(pool.normal, normal);
  push(pool.box_min, glm::dvec3(box.min));
  push(pool.box_max, glm::dvec3(box.max));
  pool.prim.push_back(prim_id_count());
  pool.first_vertex.push_back(static_cast<std::int32_t>(pool.vertex[0].size()));
  add_prim(PrimKind::polygon, pool.size() - 1);
}

void Scene::add_cone(const glm::dvec3& base, double base_radius, const glm::dvec3& apex, double apex_radius) {
  const glm::dvec3 axis = rounded(apex) - rounded(base);
  if (!in_range(base) || !in_range(apex) || !valid_radius(base_radius) || !valid_radius(apex_radius)) return drop();
  ConePool& pool = pools_.cones;
  pool.prim.push_back(prim_id_count());
  push(pool.base, base);
  push(pool.axis, axis);
  pool.radius[0].push_back(static_cast<float>(base_radius));
  pool.radius[1].push_back(static_cast<float>(apex_radius));
  const Aabb box = tight_bounds(pools_, prim_ref(PrimKind::cone, pool.size() - 1));
  push(pool.box_min, glm::dvec3(box.min));
  push(pool.box_max, glm::dvec3(box.max));
  add_prim(PrimKind::cone, pool.size() - 1);
}

void Scene::set_material(const Material& material) {
  if (!materials_.empty() && materials_.back().material == material) return;
  if (!materials_.empty() && materials_.back().first_prim == prim_id_count())
    materials_.back().material = material;
  else
    materials_.push_back({prim_id_count(), material});
}

void Scene::begin_object(std::string object_name, const glm::dmat4& to_world) {
  end_object();
  objects_.push_back({std::move(object_name), prim_id_count(), prim_id_count(), to_world});
  object_open_ = true;
}

void Scene::end_object() {
  if (!object_open_) return;
  object_open_ = false;
  objects_.back().end_prim = prim_id_count();
  if (objects_.back().first_prim == objects_.back().end_prim) objects_.pop_back();
}

void Scene::reserve(PrimKind kind, std::size_t count) {
  prims_.reserve(prims_.size() + count);
  switch (kind) {
    case PrimKind::sphere:
      reserve3(pools_.spheres.center, count);
      pools_.spheres.radius.reserve(count);
      pools_.spheres.prim.reserve(count);
      break;
    case PrimKind::triangle:
      for (FloatColumns3& vertex : pools_.triangles.vertex) reserve3(vertex, count);
      pools_.triangles.prim.reserve(count);
      break;
    case PrimKind::polygon: pools_.polygons.prim.reserve(count); break;
    case PrimKind::cone:
      for (FloatColumns3* columns : {&pools_.cones.base, &pools_.cones.axis, &pools_.cones.box_min, &pools_.cones.box_max}) reserve3(*columns, count);
      for (Column<float>& radius : pools_.cones.radius) radius.reserve(count);
      pools_.cones.prim.reserve(count);
      break;
  }
}

void Scene::finish() {
  end_object();
  SpherePool& spheres = pools_.spheres;
  shrink3(spheres.center);
  spheres.radius.shrink_to_fit();
  spheres.prim.shrink_to_fit();
  TrianglePool& triangles = pools_.triangles;
  for (std::size_t k = 0; k < 3; ++k) {
    shrink3(triangles.vertex[k]);
    shrink3(triangles.normal[k]);
  }
  triangles.prim.shrink_to_fit();
  triangles.normal_index.shrink_to_fit();
  PolygonPool& polygons = pools_.polygons;
  for (FloatColumns3* columns : {&polygons.vertex, &polygons.normal, &polygons.box_min, &polygons.box_max}) shrink3(*columns);
  polygons.first_vertex.shrink_to_fit();
  polygons.prim.shrink_to_fit();
  ConePool& cones = pools_.cones;
  for (FloatColumns3* columns : {&cones.base, &cones.axis, &cones.box_min, &cones.box_max}) shrink3(*columns);
  for (Column<float>& radius : cones.radius) radius.shrink_to_fit();
  cones.prim.shrink_to_fit();
  prims_.shrink_to_fit();
}

const Material& Scene::material(std::int32_t prim) const noexcept {
  static const Material kDefault;
  const auto next = std::upper_bound(materials_.begin(), materials_.end(), prim, [](std::int32_t id, const MaterialRun& run) { return id < run.first_prim; });
  return next == materials_.begin() ? kDefault : std::prev(next)->material;
}

const Object* Scene::object_of(std::int32_t prim) const noexcept {
  const auto next = std::upper_bound(objects_.begin(), objects_.end(), prim, [](std::int32_t id, const Object& object) { return id < object.first_prim; });
  if (next == objects_.begin() || prim >= std::prev(next)->end_prim) return nullptr;
  return &*std::prev(next);
}

std::int32_t Scene::object_count() const noexcept {
  std::int32_t lone = prim_id_count();
  for (const Object& object : objects_) lone -= object.end_prim - object.first_prim;
  return lone + static_cast<std::int32_t>(objects_.size());
}

std::size_t Scene::mem_bytes() const noexcept {
  return pools_.mem_bytes() + prims_.bytes() + materials_.capacity() * sizeof(MaterialRun) + objects_.capacity() * sizeof(Object);
}

}  // namespace raymeter
