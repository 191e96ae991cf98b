#pragma once

#include <cstddef>
#include <cstdint>

#include <glm/vec3.hpp>

#include "core/base/column.h"
#include "core/ray/ray_batch.h"
#include "core/ray/shadow_origins.h"

namespace raymeter {

enum class Origin : std::uint8_t { eye, reflection, refraction };

/// Rays of one origin and one depth that are traced and shaded together. They come from different pixels, in the order of their slots. Memory is kept for the
/// next generation: what goes back to the system costs page faults.
struct Generation {
  Origin origin = Origin::eye;
  int depth = 1;
  std::int32_t node = RayTree::kEye;
  RayBatch rays;
  Column<std::int32_t> slot;  ///< of the pixel in its tile
  Column<glm::vec3> weight;   ///< share of the ray's radiance in the pixel's, per colour channel

  void set(std::size_t i, const Ray& ray, std::int32_t pixel_slot, const glm::vec3& ray_weight) noexcept {
    rays.set(i, ray);
    slot[i] = pixel_slot;
    weight[i] = ray_weight;
  }
  void resize(std::size_t size) {
    rays.resize(size);
    slot.resize(size);
    weight.resize(size);
  }
  [[nodiscard]] std::size_t size() const noexcept { return rays.size(); }
};

/// Shadow rays towards one light.
struct ShadowRays {
  RayBatch rays;
  ShadowOrigins origins;
  Column<std::int32_t> point;  ///< number of the shading point that each leaves

  void resize(std::size_t size) {
    rays.resize(size);
    origins.resize(size);
    point.resize(size);
  }
  [[nodiscard]] std::size_t size() const noexcept { return rays.size(); }
};

}  // namespace raymeter
