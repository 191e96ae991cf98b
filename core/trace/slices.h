#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "core/ray/views.h"

namespace raymeter {

/// Rays per slice: the grain of threads and of virtual calls. A multiple of the largest packet, so that packets do not depend on threads.
inline constexpr std::int32_t kSliceRays = 1024;

[[nodiscard]] constexpr std::size_t slice_count(std::size_t ray_count) noexcept { return (ray_count + kSliceRays - 1) / kSliceRays; }

/// Rays [first, first + count).
[[nodiscard]] RayView slice_of(const RayView& rays, std::int32_t first, std::int32_t count) noexcept;

/// Calls work(slice, first, count) for each slice of `ray_count` rays, on at most `threads` threads (0: all), in IeeeArithmetic.
void for_each_slice(std::size_t ray_count, int threads, const std::function<void(std::size_t slice, std::size_t first, std::size_t count)>& work);

}  // namespace raymeter
