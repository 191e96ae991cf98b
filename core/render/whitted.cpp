#include "core/render/whitted.h"

#include <algorithm>
#include <chrono>
#include <memory>

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "core/base/threads.h"
#include "core/ray/pixel_order.h"
#include "core/render/radiance_bound.h"
#include "core/render/tile_tracer.h"

namespace raymeter {

namespace {

// In blocks of PixelOrder. A tile of a thread: large enough for packets of late generations, small enough for a cache and for many threads.
constexpr std::int32_t kTileBlocks = 16;
// A tile that all threads share, one after the other: enough slices for many.
constexpr std::int32_t kSharedTileBlocks = 256;

/// Calls trace(pixels) for tiles `first` to `last` of so many blocks.
template <class Trace>
void for_tiles(const CameraModel& model, std::int32_t blocks, std::int32_t first, std::int32_t last, Trace&& trace) {
  const PixelOrder order(model.width, model.height);
  Column<std::int32_t> pixels;
  for (std::int32_t tile = first; tile < last; ++tile) {
    pixels.clear();
    for (std::int32_t block = tile * blocks; block < std::min((tile + 1) * blocks, order.block_count()); ++block) order.append_block(block, pixels);
    trace(pixels);
  }
}

std::int32_t tile_count(const CameraModel& model, std::int32_t blocks) { return (PixelOrder(model.width, model.height).block_count() + blocks - 1) / blocks; }

void add_sums(const TileTracer& tracer, Rendering& out) {
  out.rays.add(tracer.rays());
  out.depth.add(tracer.depth());
  out.totals.add(tracer.totals());
}

/// One tile after the other, in the frame's order.
void trace_in_order(const TracedFrame& frame, Occlusion& occlusion, Rendering& out) {
  TileTracer tracer(frame, occlusion, frame.options.threads);
  const CameraModel& model = frame.options.model;
  for_tiles(model, kSharedTileBlocks, 0, tile_count(model, kSharedTileBlocks), [&](const Column<std::int32_t>& pixels) { tracer.trace_tile(pixels); });
  add_sums(tracer, out);
}

/// A thread's share.
struct Worker {
  Worker(const TracedFrame& frame, const Occlusion& all) : occlusion(all.for_tiles()), tracer(frame, *occlusion, 1) {}
  std::unique_ptr<Occlusion> occlusion;
  TileTracer tracer;
};

void trace_side_by_side(const TracedFrame& frame, const Occlusion& occlusion, Rendering& out) {
  const CameraModel& model = frame.options.model;
  tbb::enumerable_thread_specific<Worker> workers([&] { return Worker(frame, occlusion); });
  on_threads(frame.options.threads, [&] {
    tbb::parallel_for(
        tbb::blocked_range<std::int32_t>(0, tile_count(model, kTileBlocks)),
        [&](const tbb::blocked_range<std::int32_t>& tiles) {
          Worker& worker = workers.local();
          for_tiles(model, kTileBlocks, tiles.begin(), tiles.end(), [&](const Column<std::int32_t>& pixels) {
            worker.occlusion->begin();
            worker.tracer.trace_tile(pixels);
          });
        },
        tbb::simple_partitioner());
  });
  for (const Worker& worker : workers) add_sums(worker.tracer, out);
}

/// Makes what threads spent in phases shares of what the clock says.
void scale_time(FrameTotals& totals, double wall_ms) {
  const double spent_ms = totals.sum().ms;
  if (!(spent_ms > 0)) return;
  for (PhaseTotals& phase : totals.phase) phase.ms *= wall_ms / spent_ms;
}

}  // namespace

Rendering render(const Scene& scene, FirstHit& first_hit, Intersector& intersector, const RenderOptions& options) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const CameraModel& model = options.model;
  Rendering out;
  out.image = {model.width, model.height, Column<glm::vec3>(static_cast<std::size_t>(model.pixel_count()), glm::vec3(0))};
  TracedFrame frame{scene, first_hit, intersector, options,  options.general ? all_needs() : needs_of(scene), surface_rules(model.convention),
                    {},    {},        out.image,   out.bound};
  if (options.bound) {
    frame.largest = largest_radiance(scene, options.termination.max_depth);
    out.bound.resize(out.image.pixel.size(), glm::vec3(0));
  }
  TracedOcclusion traced(intersector);
  Occlusion& occlusion = options.occlusion != nullptr ? *options.occlusion : traced;
  FrameTotals before;
  before.measure(FramePhase::first_hit, 0, false, [&](Counters*) { first_hit.begin(model, options.threads); });
  before.measure(FramePhase::shadow, 0, false, [&](Counters*) {
    frame.lights = options.lights != nullptr ? *options.lights : light_targets(scene, scene.lights, options.threads);
    occlusion.begin();
  });
  if (options.termination.traces_eye_rays()) {
    const bool in_order = intersector.keeps_batch() || occlusion.needs_order();
    in_order ? trace_in_order(frame, occlusion, out) : trace_side_by_side(frame, occlusion, out);
  }
  const double wall_ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  scale_time(out.totals, wall_ms - before.sum().ms);
  out.totals.add(before);
  return out;
}

}  // namespace raymeter
