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

/// The hits of a generation as shading sees them, each slice's in its rays' order. Memory is kept for the next generation, as in all that follows: what goes
/// back to the system costs page faults.
struct ShadingPoints {
  std::vector<std::vector<ShadingPoint>> of_slice;  ///< of the first `slices` only
  std::size_t slices = 0;

  void begin(std::size_t ray_count) {
    slices = slice_count(ray_count);
    if (of_slice.size() < slices) of_slice.resize(slices);
  }
};

/// Calls work(slice) for each slice of points.
template <class Work>
void for_each_part(const ShadingPoints& points, int threads, Work&& work) {
  for_each_slice(points.slices * kSliceRays, threads, [&](std::size_t slice, std::size_t, std::size_t) { work(slice); });
}

/// Makes `parts`, a batch for each slice: what emit(batch, point) adds for each of its points.
template <class Batch, class Emit>
void emit_parts(const ShadingPoints& points, int threads, std::vector<Batch>& parts, Emit emit) {
  if (parts.size() < points.slices) parts.resize(points.slices);
  for_each_part(points, threads, [&](std::size_t slice) {
    parts[slice].resize(0);
    parts[slice].reserve(points.of_slice[slice].size());
    for (const ShadingPoint& point : points.of_slice[slice]) emit(parts[slice], point);
  });
}

/// Makes `all` of the batches of slices, one after the other whatever the threads.
template <class Batch>
void join_parts(const ShadingPoints& points, int threads, const std::vector<Batch>& parts, Batch& all) {
  std::vector<std::size_t> first(points.slices + 1, 0);
  for (std::size_t slice = 0; slice < points.slices; ++slice) first[slice + 1] = first[slice] + parts[slice].size();
  all.resize(first.back());
  for_each_part(points, threads, [&](std::size_t slice) { all.place_part(first[slice], parts[slice]); });
}

}  // namespace raymeter
