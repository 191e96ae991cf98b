#pragma once

#include <cstdint>

#include "core/base/column.h"
#include "core/scene/camera.h"
#include "core/stats/counters.h"
#include "core/trace/intersector.h"

namespace raymeter {

/// How often `event` happened to the eye ray of each pixel, [y * width + x]. Rays are traced one by one, whatever the intersector's packet size: a pixel's
/// count is its own ray's.
[[nodiscard]] Column<std::uint64_t> events_per_pixel(const CameraModel& model, Intersector& intersector, Event event, int threads);

}  // namespace raymeter
