#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "accel/embree/embree_scene.h"
#include "core/ray/trace_args.h"

namespace raymeter {

/// How rays are handed to Embree: a packet width, or a stream of a whole slice.
enum class EmbreeLayout : std::uint8_t { single, packet4, packet8, packet16, stream, stream_soa };

struct EmbreeMode {
  EmbreeLayout layout = EmbreeLayout::packet16;
  bool coherent = true;
};

/// All of them, in the order in which `best` tries them.
[[nodiscard]] std::span<const EmbreeMode> embree_modes() noexcept;
[[nodiscard]] std::string_view name(EmbreeLayout layout) noexcept;

/// Bytes of `count` rays in a layout.
[[nodiscard]] std::size_t embree_bytes(EmbreeLayout layout, Query query, std::int32_t count) noexcept;
/// Brings rays into a layout. `out` is 64-byte aligned. Invalid rays become such that Embree lets them miss.
void to_embree(EmbreeLayout layout, Query query, const RayView& rays, std::byte* out) noexcept;
/// Traces rays that to_embree() has written, which are overwritten, and brings what they meet back. What blocks a ray Embree does not tell: kUnknownBlocker.
void trace_embree(const EmbreeScene& scene, EmbreeMode mode, Query query, std::byte* rays, const HitView& hits, std::int32_t* blocker,
                  std::int32_t count) noexcept;

}  // namespace raymeter
