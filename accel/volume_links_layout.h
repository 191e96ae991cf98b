#pragma once

#include <cstddef>
#include <cstdint>

#include "core/bounds/volume_layout.h"
#include "core/geometry/primitive_run.h"
#include "core/scene/pools_view.h"

namespace raymeter {

/// What lies in a bounding volume; the volume's data stands behind it in memory.
struct VolumeLink {
  static constexpr std::uint32_t kInner = 8;  ///< a node: first = its first child's link, count = children, which are consecutive
  static constexpr std::uint32_t kRuns = 9;   ///< primitives of several kinds: first = their first run, count = runs
  std::uint32_t tag_and_count;                ///< tag in the upper 4 bits: kInner, kRuns, or a primitive kind: one run
  std::int32_t first;

  [[nodiscard]] constexpr std::uint32_t tag() const noexcept { return tag_and_count >> PrimitiveRun::kCountBits; }
  [[nodiscard]] constexpr std::int32_t count() const noexcept { return static_cast<std::int32_t>(tag_and_count & ((1u << PrimitiveRun::kCountBits) - 1)); }
};
[[nodiscard]] constexpr VolumeLink volume_link(std::uint32_t tag, std::size_t first, std::size_t count) noexcept {
  return {tag << PrimitiveRun::kCountBits | static_cast<std::uint32_t>(count), static_cast<std::int32_t>(first)};
}

/// Bytes from one link to the next: up to 6 floats a volume 32, so that two children share a cache line.
[[nodiscard]] constexpr std::int32_t volume_link_bytes(std::int32_t volume_floats) noexcept {
  const auto bytes = static_cast<std::int32_t>(sizeof(VolumeLink)) + volume_floats * static_cast<std::int32_t>(sizeof(float));
  return bytes < 32 ? 32 : bytes;
}

/// Links with their volumes, and the primitives that they lead to.
template <class Layout>
struct VolumeLinksView {
  const std::byte* links;
  const PrimitiveRun* runs;
  PoolsView pools;
  typename Layout::Shared shared;
  std::int32_t runtime_link_bytes;

  [[nodiscard]] const std::byte* address(std::int32_t link) const noexcept {
    if constexpr (Layout::kFloats > 0)
      return links + static_cast<std::int64_t>(link) * volume_link_bytes(Layout::kFloats);
    else
      return links + static_cast<std::int64_t>(link) * runtime_link_bytes;
  }
  [[nodiscard]] const VolumeLink& link(std::int32_t i) const noexcept { return *reinterpret_cast<const VolumeLink*>(address(i)); }
  [[nodiscard]] const float* volume(std::int32_t i) const noexcept { return reinterpret_cast<const float*>(address(i) + sizeof(VolumeLink)); }
};

}  // namespace raymeter
