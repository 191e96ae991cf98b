#include "core/trace/trace.h"

#include <algorithm>

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "core/base/threads.h"

namespace raymeter {

namespace {

struct Worker {
  Column<std::byte> scratch;
  Counters counters;
};

/// Calls trace(first, count, counters or null, scratch) for every slice.
template <class Trace>
void for_each_slice(const Intersector& intersector, std::size_t ray_count, int threads, Counters* counters, Trace&& trace) {
  const std::size_t slices = (ray_count + kSliceRays - 1) / kSliceRays;
  const auto run = [&](Worker& worker, std::size_t slice) {
    const std::size_t first = slice * kSliceRays;
    const std::size_t count = std::min<std::size_t>(kSliceRays, ray_count - first);
    trace(first, count, counters != nullptr ? &worker.counters : nullptr, worker.scratch.data());
  };
  const auto new_worker = [&] { return Worker{Column<std::byte>(std::max<std::size_t>(64, intersector.scratch_bytes())), {}}; };
  const auto take = [&](const Worker& worker) {
    if (counters != nullptr) counters->add(worker.counters);
  };
  if (threads == 1) {
    Worker worker = new_worker();
    for (std::size_t slice = 0; slice < slices; ++slice) run(worker, slice);
    take(worker);
  } else {
    tbb::enumerable_thread_specific<Worker> workers(new_worker);
    on_threads(threads, [&] {
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, slices), [&](const tbb::blocked_range<std::size_t>& range) {
        Worker& worker = workers.local();
        for (std::size_t slice = range.begin(); slice < range.end(); ++slice) run(worker, slice);
      });
    });
    for (const Worker& worker : workers) take(worker);
  }
  if (counters != nullptr) counters->ray_count += ray_count;
}

}  // namespace

void trace_closest(const Intersector& intersector, const RayBatch& rays, HitBatch& hits, int threads, Counters* counters) {
  hits.resize(rays.size());
  for_each_slice(intersector, rays.size(), threads, counters, [&](std::size_t first, std::size_t count, Counters* sums, std::byte* scratch) {
    intersector.closest_hit(rays.view(first, count), hits.view(first, count), sums, scratch);
  });
}

void trace_any(const Intersector& intersector, const RayBatch& rays, Column<std::int32_t>& blocker, int threads, Counters* counters) {
  blocker.resize(rays.size(), -1);
  for_each_slice(intersector, rays.size(), threads, counters, [&](std::size_t first, std::size_t count, Counters* sums, std::byte* scratch) {
    intersector.any_hit(rays.view(first, count), blocker.data() + first, sums, scratch);
  });
}

}  // namespace raymeter
