#include "core/trace/slices.h"

#include <algorithm>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "core/base/ieee_arithmetic.h"
#include "core/base/threads.h"

namespace raymeter {

RayView slice_of(const RayView& rays, std::int32_t first, std::int32_t count) noexcept {
  RayView slice = rays;
  for (int a = 0; a < 3; ++a) {
    slice.org[a] += first;
    slice.dir[a] += first;
  }
  slice.t_min += first;
  slice.t_max += first;
  slice.count = count;
  return slice;
}

void for_each_slice(std::size_t ray_count, int threads, const std::function<void(std::size_t, std::size_t, std::size_t)>& work) {
  const std::size_t slices = slice_count(ray_count);
  const auto run = [&](std::size_t begin, std::size_t end) {
    const IeeeArithmetic ieee;
    for (std::size_t slice = begin; slice < end; ++slice) {
      const std::size_t first = slice * kSliceRays;
      work(slice, first, std::min<std::size_t>(kSliceRays, ray_count - first));
    }
  };
  if (threads == 1 || slices <= 1) return run(0, slices);
  on_threads(threads, [&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, slices), [&](const tbb::blocked_range<std::size_t>& range) { run(range.begin(), range.end()); });
  });
}

}  // namespace raymeter
