#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "core/base/column.h"
#include "core/ray/ray_batch.h"
#include "core/ray/shadow_origins.h"
#include "core/render/shading.h"
#include "core/trace/slices.h"

namespace raymeter {

/// Puts a part's column into its place in the whole.
template <class T>
void place(Column<T>& whole, std::size_t at, const Column<T>& part) {
  std::copy(part.begin(), part.end(), whole.begin() + at);
}
inline void place(RayBatch& whole, std::size_t at, const RayBatch& part) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    place(whole.org[axis], at, part.org[axis]);
    place(whole.dir[axis], at, part.dir[axis]);
  }
  place(whole.t_min, at, part.t_min);
  place(whole.t_max, at, part.t_max);
}

inline void place(ShadowOrigins& whole, std::size_t at, const ShadowOrigins& part) {
  place(whole.light, at, part.light);
  place(whole.source, at, part.source);
}

enum class Origin : std::uint8_t { eye, reflection, refraction };

/// Rays of one origin and one depth that are traced and shaded together. They come from different pixels, in the order of their slots: what they add to their
/// pixels can be added in parallel, and the sums do not depend on threads.
struct Generation {
  Origin origin = Origin::eye;
  int depth = 1;
  std::int32_t node = RayTree::kEye;
  RayBatch rays;
  Column<std::int32_t> slot;  ///< of the pixel in its band
  Column<glm::vec3> weight;   ///< share of the ray's radiance in the pixel's, per colour channel
  std::int64_t tir = 0;       ///< reflections that stand for a refraction, followed or not

  void push_back(const Ray& ray, std::int32_t pixel_slot, const glm::vec3& ray_weight) {
    rays.push_back(ray);
    slot.push_back(pixel_slot);
    weight.push_back(ray_weight);
  }
  void reserve(std::size_t size) {
    rays.reserve(size);
    slot.reserve(size);
    weight.reserve(size);
  }
  void resize(std::size_t size) {
    rays.resize(size);
    slot.resize(size);
    weight.resize(size);
  }
  void place_part(std::size_t at, const Generation& part) {
    place(rays, at, part.rays);
    place(slot, at, part.slot);
    place(weight, at, part.weight);
  }
  [[nodiscard]] std::size_t size() const noexcept { return rays.size(); }
};

/// Shadow rays towards one light, and what they bring to their pixels unless they are blocked.
struct ShadowRays {
  RayBatch rays;
  ShadowOrigins origins;
  Column<std::int32_t> slot;
  Column<glm::vec3> radiance;

  void reserve(std::size_t size) {
    rays.reserve(size);
    origins.reserve(size);
    slot.reserve(size);
    radiance.reserve(size);
  }
  void resize(std::size_t size) {
    rays.resize(size);
    origins.resize(size);
    slot.resize(size);
    radiance.resize(size);
  }
  void place_part(std::size_t at, const ShadowRays& part) {
    place(rays, at, part.rays);
    place(origins, at, part.origins);
    place(slot, at, part.slot);
    place(radiance, at, part.radiance);
  }
  [[nodiscard]] std::size_t size() const noexcept { return rays.size(); }
};

/// The hits of a generation's slices as shading sees them, each slice's in its rays' order.
using ShadingPoints = std::vector<std::vector<ShadingPoint>>;

/// Calls work(slice) for each slice of points.
template <class Work>
void for_each_part(const ShadingPoints& points, int threads, Work&& work) {
  for_each_slice(points.size() * kSliceRays, threads, [&](std::size_t slice, std::size_t, std::size_t) { work(slice); });
}

/// What emit(batch, point) adds for each point, in batches of their own for each slice.
template <class Batch, class Emit>
std::vector<Batch> emitted(const ShadingPoints& points, int threads, Emit emit) {
  std::vector<Batch> parts(points.size());
  for_each_part(points, threads, [&](std::size_t slice) {
    parts[slice].reserve(points[slice].size());
    for (const ShadingPoint& point : points[slice]) emit(parts[slice], point);
  });
  return parts;
}

/// The batches of slices one after the other, whatever the threads.
template <class Batch>
Batch joined(const ShadingPoints& points, const std::vector<Batch>& parts, int threads) {
  std::vector<std::size_t> first(parts.size() + 1, 0);
  for (std::size_t slice = 0; slice < parts.size(); ++slice) first[slice + 1] = first[slice] + parts[slice].size();
  Batch all;
  all.resize(first.back());
  for_each_part(points, threads, [&](std::size_t slice) { all.place_part(first[slice], parts[slice]); });
  return all;
}

}  // namespace raymeter
