#include "core/trace/trace.h"

#include <algorithm>

#include <tbb/enumerable_thread_specific.h>

namespace raymeter {

namespace {

/// The thread's scratch space, kept from batch to batch: a frame has many small ones, and a heap takes megabytes.
std::byte* scratch_of_thread(std::size_t bytes) {
  thread_local Column<std::byte> scratch;
  if (scratch.size() < bytes) scratch = Column<std::byte>(bytes);
  return scratch.data();
}

/// Calls trace(first, count, counters or null, scratch) for every slice.
template <class Trace>
void trace_slices(const Intersector& intersector, std::size_t ray_count, int threads, Counters* counters, Trace&& trace) {
  const std::size_t scratch_bytes = std::max<std::size_t>(64, intersector.scratch_bytes());
  tbb::enumerable_thread_specific<Counters> sums;
  for_each_slice(ray_count, threads, [&](std::size_t, std::size_t first, std::size_t count) {
    trace(first, count, counters != nullptr ? &sums.local() : nullptr, scratch_of_thread(scratch_bytes));
  });
  if (counters == nullptr) return;
  for (const Counters& sum : sums) counters->add(sum);
  counters->ray_count += ray_count;
}

}  // namespace

void trace_closest(const Intersector& intersector, const RayBatch& rays, HitBatch& hits, int threads, Counters* counters) {
  hits.resize(rays.size());
  trace_slices(intersector, rays.size(), threads, counters, [&](std::size_t first, std::size_t count, Counters* sums, std::byte* scratch) {
    intersector.closest_hit(rays.view(first, count), hits.view(first, count), sums, scratch);
  });
}

void trace_any(const Intersector& intersector, const RayBatch& rays, Column<std::int32_t>& blocker, int threads, Counters* counters) {
  blocker.resize(rays.size(), -1);
  trace_slices(intersector, rays.size(), threads, counters, [&](std::size_t first, std::size_t count, Counters* sums, std::byte* scratch) {
    intersector.any_hit(rays.view(first, count), blocker.data() + first, sums, scratch);
  });
}

std::string choices(const Intersector& intersector) {
  const std::string closest = intersector.choice(Query::closest), any = intersector.choice(Query::any);
  return any.empty() ? closest : closest + (closest.empty() ? "any: " : "; any: ") + any;
}

}  // namespace raymeter
