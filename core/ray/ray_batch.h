#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/column.h"
#include "core/ray/views.h"

namespace raymeter {

/// One ray, for callers that make or look at them one by one.
struct Ray {
  float org[3];
  float t_min;
  float dir[3];
  float t_max;
};

/// A batch of rays as a structure of arrays; independent of any SIMD width.
struct RayBatch {
  std::array<Column<float>, 3> org;
  std::array<Column<float>, 3> dir;
  Column<float> t_min;
  Column<float> t_max;

  [[nodiscard]] std::size_t size() const noexcept { return t_min.size(); }
  void resize(std::size_t size);
  void reserve(std::size_t size);
  void clear() noexcept;
  void push_back(const Ray& ray);
  void append(const RayBatch& other);
  void set(std::size_t i, const Ray& ray) noexcept;
  [[nodiscard]] Ray operator[](std::size_t i) const noexcept;
  /// Rays [first, first + count).
  [[nodiscard]] RayView view(std::size_t first, std::size_t count) const noexcept;
  [[nodiscard]] RayView view() const noexcept { return view(0, size()); }
};

/// The nearest hits of a batch; see HitView for the conventions.
struct HitBatch {
  Column<float> t;
  Column<std::int32_t> prim;
  Column<float> u;
  Column<float> v;

  [[nodiscard]] std::size_t size() const noexcept { return t.size(); }
  void resize(std::size_t size);
  [[nodiscard]] HitView view(std::size_t first, std::size_t count) noexcept;
  [[nodiscard]] HitView view() noexcept { return view(0, size()); }
};

/// Whether every column of both holds the same bits.
[[nodiscard]] bool bits_equal(const HitBatch& a, const HitBatch& b) noexcept;

}  // namespace raymeter
