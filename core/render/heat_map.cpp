#include "core/render/heat_map.h"

#include <algorithm>

#include "core/ray/generators.h"
#include "core/trace/trace.h"

namespace raymeter {

Column<std::uint64_t> events_per_pixel(const CameraModel& model, Intersector& intersector, Event event, int threads) {
  Column<std::int32_t> pixels(static_cast<std::size_t>(model.pixel_count()));
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<std::int32_t>(i);
  RayBatch rays;
  eye_rays(model, pixels, rays, threads);
  intersector.prepare(rays.view(), Query::closest, threads);
  const std::int32_t* const order = intersector.order();
  HitBatch hits;
  hits.resize(rays.size());
  Column<std::uint64_t> events(rays.size());
  for_each_slice(rays.size(), threads, [&](std::size_t, std::size_t first, std::size_t count) {
    Column<std::byte> scratch(std::max<std::size_t>(64, intersector.scratch_bytes()));
    const Intersector& suited = intersector.suited(rays.view(first, count), Query::closest);
    for (std::size_t i = first; i < first + count; ++i) {
      Counters counters;
      suited.closest_hit(rays.view(i, 1), hits.view(i, 1), &counters, scratch.data());
      events[order != nullptr ? static_cast<std::size_t>(order[i]) : i] = counters.live(event);
    }
  });
  return events;
}

}  // namespace raymeter
