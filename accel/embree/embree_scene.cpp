#include "accel/embree/embree_scene.h"

#include <string>

#include "accel/embree/polygon_triangles.h"

namespace raymeter {

namespace {

/// Embree's name of an instruction set; null where it has none.
const char* embree_name(Isa isa) noexcept {
  switch (isa) {
    case Isa::sse42: return "sse4.2";
    case Isa::avx2: return "avx2";
    case Isa::avx512: return "avx512";
    case Isa::scalar: break;
  }
  return nullptr;
}

bool count_bytes(void* sum, ssize_t bytes, bool) {
  *static_cast<std::atomic<std::int64_t>*>(sum) += bytes;
  return true;
}

}  // namespace

std::string why_not_embree(const Scene& scene, Isa isa) {
  // Its cones have either ends, which ours have not, or no inner side: rays that come in by an open end meet nothing.
  if (scene.pools().cones.size() > 0) return "it has no open cones and cylinders, and the scene has some";
  if (embree_name(isa) == nullptr) return "it has no code for the instruction set " + std::string(name(isa));
  return {};
}

EmbreeScene::EmbreeScene(const Scene& scene, const EmbreeParams& params, Isa isa, int threads)
    : prim_of_{scene.pools().triangles.prim.data(), scene.pools().spheres.prim.data(), nullptr} {
  if (const std::string why = why_not_embree(scene, isa); !why.empty()) throw Error("embree: " + why);
  std::string config = std::string("isa=") + embree_name(isa);
  if (threads > 0) config += ",threads=" + std::to_string(threads);
  device_.reset(rtcNewDevice(config.c_str()));
  if (!device_) throw Error("embree: no device with " + config);
  scene_.reset(rtcNewScene(device_.get()));
  rtcSetSceneFlags(scene_.get(), params.robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
  rtcSetSceneBuildQuality(scene_.get(), params.quality == "high" ? RTC_BUILD_QUALITY_HIGH : RTC_BUILD_QUALITY_MEDIUM);
  rtcSetDeviceMemoryMonitorFunction(device_.get(), count_bytes, &bytes_);
  add_triangles(scene.pools().triangles);
  add_spheres(scene.pools().spheres);
  add_polygons(scene.pools().polygons);
  rtcCommitScene(scene_.get());
  check("building");
}

void EmbreeScene::add_triangles(const TrianglePool& pool) {
  const std::size_t count = pool.size();
  if (count == 0) return;
  vertices_.resize(count * 9);
  indices_.resize(count * 3);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t a = 0; a < 3; ++a) vertices_[i * 9 + k * 3 + a] = pool.vertex[k][a][i];
      indices_[i * 3 + k] = static_cast<std::uint32_t>(i * 3 + k);
    }
  }
  attach_triangles(0, vertices_, indices_);
}

void EmbreeScene::add_polygons(const PolygonPool& pool) {
  const PolygonTriangles triangles = triangles_of(pool);
  const std::size_t count = triangles.vertex.size();
  if (count == 0) return;
  polygon_vertices_.resize(pool.vertex[0].size() * 3);
  for (std::size_t i = 0; i < pool.vertex[0].size(); ++i) {
    for (std::size_t a = 0; a < 3; ++a) polygon_vertices_[i * 3 + a] = pool.vertex[a][i];
  }
  polygon_indices_.resize(count * 3);
  polygon_prim_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < 3; ++k) polygon_indices_[i * 3 + k] = triangles.vertex[i][k];
    polygon_prim_[i] = pool.prim[static_cast<std::size_t>(triangles.polygon[i])];
  }
  prim_of_[2] = polygon_prim_.data();
  attach_triangles(2, polygon_vertices_, polygon_indices_);
}

void EmbreeScene::attach_triangles(unsigned id, const Column<float>& vertices, const Column<std::uint32_t>& indices) {
  RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices.data(), 0, 3 * sizeof(float), vertices.size() / 3);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, indices.data(), 0, 3 * sizeof(std::uint32_t), indices.size() / 3);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene_.get(), geometry, id);
  rtcReleaseGeometry(geometry);
  check("triangles");
}

void EmbreeScene::add_spheres(const SpherePool& pool) {
  const std::size_t count = pool.size();
  if (count == 0) return;
  spheres_.resize(count * 4);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t a = 0; a < 3; ++a) spheres_[i * 4 + a] = pool.center[a][i];
    spheres_[i * 4 + 3] = pool.radius[i];
  }
  RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_SPHERE_POINT);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, spheres_.data(), 0, 4 * sizeof(float), count);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene_.get(), geometry, 1);
  rtcReleaseGeometry(geometry);
  check("spheres");
}

void EmbreeScene::check(const char* step) const {
  const RTCError error = rtcGetDeviceError(device_.get());
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  if (error != RTC_ERROR_NONE) throw Error("embree: " + std::string(step) + " failed with error " + std::to_string(static_cast<int>(error)));
}

}  // namespace raymeter
