#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

#include <embree3/rtcore.h>

#include "accel/embree/embree.h"
#include "core/base/column.h"
#include "core/simd/isa.h"

namespace raymeter {

/// A committed Embree scene for one instruction set, with its device. Geometry 0 holds the triangles, geometry 1 the spheres, each in the order of its pool,
/// geometry 2 the triangles of the polygons.
class EmbreeScene {
public:
  /// Throws Error where Embree cannot: no such instruction set, other primitives, out of memory.
  EmbreeScene(const Scene& scene, const EmbreeParams& params, Isa isa, int threads);

  [[nodiscard]] RTCScene get() const noexcept { return scene_.get(); }
  /// The id of a primitive that Embree names.
  [[nodiscard]] std::int32_t prim(unsigned geometry, unsigned index) const noexcept { return prim_of_[geometry][index]; }
  /// Nodes and leaves; without the vertices, which Embree shares with raymeter.
  [[nodiscard]] std::size_t mem_bytes() const noexcept { return static_cast<std::size_t>(bytes_.load()); }

private:
  void add_triangles(const TrianglePool& pool);
  void add_spheres(const SpherePool& pool);
  void add_polygons(const PolygonPool& pool);
  /// Attaches triangles, whose columns the scene shares, as a geometry.
  void attach_triangles(unsigned id, const Column<float>& vertices, const Column<std::uint32_t>& indices);
  void check(const char* step) const;

  struct Release {
    void operator()(RTCDevice device) const noexcept { rtcReleaseDevice(device); }
    void operator()(RTCScene scene) const noexcept { rtcReleaseScene(scene); }
  };
  std::atomic<std::int64_t> bytes_{0};  // outlives the device, which reports to it
  std::unique_ptr<RTCDeviceTy, Release> device_;
  std::unique_ptr<RTCSceneTy, Release> scene_;
  const std::int32_t* prim_of_[3];
  Column<float> vertices_;  ///< x y z a vertex, three vertices a triangle
  Column<std::uint32_t> indices_;
  Column<float> spheres_;           ///< x y z radius
  Column<float> polygon_vertices_;  ///< x y z
  Column<std::uint32_t> polygon_indices_;
  Column<std::int32_t> polygon_prim_;  ///< of each triangle
};

}  // namespace raymeter
