#include <cstddef>
#include <cstdint>
#include <cstring>

#include "core/scene/scene.h"

namespace raymeter {

namespace {

/// FNV-1a over 64-bit words.
class Hash {
public:
  template <class T>
  void add(const Column<T>& column) noexcept {
    add_bytes(column.data(), column.size() * sizeof(T));
  }
  void add(const FloatColumns3& columns) noexcept {
    for (const Column<float>& column : columns) add(column);
  }
  void add(double value) noexcept { add_bytes(&value, sizeof value); }
  void add(const glm::dvec3& p) noexcept {
    for (glm::length_t a = 0; a < 3; ++a) add(p[a]);
  }
  [[nodiscard]] std::uint64_t value() const noexcept { return value_; }

private:
  void add_bytes(const void* data, std::size_t size) noexcept {
    const auto* bytes = static_cast<const unsigned char*>(data);
    mix(size);
    for (; size >= 8; bytes += 8, size -= 8) {
      std::uint64_t word;
      std::memcpy(&word, bytes, 8);
      mix(word);
    }
    for (; size > 0; ++bytes, --size) mix(*bytes);
  }
  void mix(std::uint64_t word) noexcept {
    value_ = (value_ ^ word) * 0x100000001b3u;
    value_ ^= value_ >> 29;
  }
  std::uint64_t value_ = 0xcbf29ce484222325u;
};

}  // namespace

std::uint64_t Scene::hash() const noexcept {
  Hash hash;
  hash.add(prims_);
  hash.add(pools_.spheres.center);
  hash.add(pools_.spheres.radius);
  for (std::size_t k = 0; k < 3; ++k) {
    hash.add(pools_.triangles.vertex[k]);
    hash.add(pools_.triangles.normal[k]);
  }
  hash.add(pools_.triangles.normal_index);
  hash.add(pools_.polygons.vertex);
  hash.add(pools_.polygons.first_vertex);
  hash.add(pools_.cones.base);
  hash.add(pools_.cones.axis);
  for (const Column<float>& radius : pools_.cones.radius) hash.add(radius);
  for (const MaterialRun& run : materials_) {
    hash.add(static_cast<double>(run.first_prim));
    hash.add(run.material.color);
    for (const double value : {run.material.diffuse, run.material.specular, run.material.shine, run.material.transmittance, run.material.ior}) hash.add(value);
  }
  for (const Light& light : lights) {
    hash.add(light.position);
    hash.add(light.color);
  }
  hash.add(camera.eye);
  hash.add(camera.look_at);
  hash.add(camera.up);
  hash.add(camera.fov_degrees);
  hash.add(background);
  return hash.value();
}

}  // namespace raymeter
