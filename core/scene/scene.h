#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "core/base/column.h"
#include "core/scene/camera.h"
#include "core/scene/pools.h"
#include "core/scene/primitive.h"

namespace raymeter {

/// Phong material in NFF's terms: colour, diffuse and specular weight, cosine power, transmittance, index of refraction.
struct Material {
  glm::dvec3 color{1.0};
  double diffuse = 1;
  double specular = 0;
  double shine = 0;
  double transmittance = 0;
  double ior = 1;

  [[nodiscard]] bool reflects() const noexcept { return specular > 0; }
  [[nodiscard]] bool transmits() const noexcept { return transmittance > 0; }
  friend bool operator==(const Material&, const Material&) = default;
};

/// Positional light without falloff.
struct Light {
  glm::dvec3 position{0.0};
  glm::dvec3 color{1.0};
  friend bool operator==(const Light&, const Light&) = default;
};

/// A composite object: primitives [first_prim, end_prim), stored in world space like all. `to_world` is the frame in which the file or generator made it
/// (identity for most).
struct Object {
  std::string name;
  std::int32_t first_prim = 0;
  std::int32_t end_prim = 0;
  glm::dmat4 to_world{1.0};
};

/// A scene: one pool per primitive kind, materials, objects, lights, camera. Coordinates are stored as float, rounded to nearest from what is added.
/// Primitive ids count from 0 in the order of addition, dropped ones included.
class Scene {
public:
  std::string name;
  glm::dvec3 background{0.0};
  std::vector<Light> lights;
  Camera camera;

  /// Coordinates and radii are to be at most this, so that products of them stay in range.
  static constexpr double kLargestCoordinate = 0x1p60;

  // ---- Making one. A primitive with a coordinate that is NaN or too large or a negative, NaN or too large radius keeps its id but is dropped and counted. A
  // triangle whose vertices lie on a line cannot be hit; it is kept as a segment, with two vertices in one place.
  void add_sphere(glm::dvec3 center, double radius);
  void add_triangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);
  /// With vertex normals, for shading only; they need not be unit vectors.
  void add_triangle(const std::array<glm::dvec3, 3>& vertex, const std::array<glm::dvec3, 3>& normal);
  /// At least 3 vertices, planar up to rounding, counterclockwise from outside; may be concave.
  void add_polygon(std::span<const glm::dvec3> vertices);
  /// Open cone or cylinder from `base` to `apex`.
  void add_cone(const glm::dvec3& base, double base_radius, const glm::dvec3& apex, double apex_radius);
  /// For all primitives added from now on.
  void set_material(const Material& material);
  /// Opens a composite object that lasts until the next begin_object or end_object; primitives outside any are objects of their own.
  void begin_object(std::string object_name, const glm::dmat4& to_world = glm::dmat4(1.0));
  void end_object();
  /// Room for primitives, before many are added.
  void reserve(PrimKind kind, std::size_t count);
  /// Gives back spare memory; call when everything has been added.
  void finish();

  // ---- Looking at one.
  /// Ids given, dropped ones included.
  [[nodiscard]] std::int32_t prim_id_count() const noexcept { return static_cast<std::int32_t>(prims_.size()); }
  /// Primitives that can be hit.
  [[nodiscard]] std::int32_t prim_count() const noexcept { return prim_id_count() - dropped_; }
  [[nodiscard]] std::int32_t dropped_count() const noexcept { return dropped_; }
  [[nodiscard]] PrimRef prim(std::int32_t id) const noexcept { return prims_[static_cast<std::size_t>(id)]; }
  [[nodiscard]] const Pools& pools() const noexcept { return pools_; }
  [[nodiscard]] const Material& material(std::int32_t prim) const noexcept;
  /// Materials as runs: each holds from its first primitive to the next run's.
  struct MaterialRun {
    std::int32_t first_prim;
    Material material;
  };
  [[nodiscard]] std::span<const MaterialRun> material_runs() const noexcept { return materials_; }
  /// Composite objects in primitive order; primitives between them stand alone.
  [[nodiscard]] std::span<const Object> objects() const noexcept { return objects_; }
  /// The composite that holds `prim`, or null where it stands alone.
  [[nodiscard]] const Object* object_of(std::int32_t prim) const noexcept;
  /// Composites plus lone primitives.
  [[nodiscard]] std::int32_t object_count() const noexcept;
  [[nodiscard]] std::size_t mem_bytes() const noexcept;
  /// Hash of geometry, materials, lights and camera, for records.
  [[nodiscard]] std::uint64_t hash() const noexcept;

private:
  void drop();
  void add_prim(PrimKind kind, std::size_t index);

  Pools pools_;
  Column<PrimRef> prims_;
  std::vector<MaterialRun> materials_;
  std::vector<Object> objects_;
  bool object_open_ = false;
  std::int32_t dropped_ = 0;
};

}  // namespace raymeter
