#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace raymeter {

/// The number of threads that 0 stands for.
[[nodiscard]] inline int all_threads() noexcept { return tbb::info::default_concurrency(); }

/// Runs `body` in an arena of `threads` threads (0: all), more than the machine has where that is asked for. Returns what it returns. An arena of so many that
/// the caller is in already serves: workers leave one only after many yields and come to the next only then, on a busy machine when all is done. There its
/// waits take no work from around it.
template <class Body>
auto on_threads(int threads, Body&& body) {
  const int count = threads > 0 ? threads : all_threads();
  if (tbb::this_task_arena::max_concurrency() == count) return tbb::this_task_arena::isolate(std::forward<Body>(body));
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(std::max(count, all_threads())));
  tbb::task_arena arena(count);
  return arena.execute(std::forward<Body>(body));
}

/// Calls body(i) for each i below `count`, on the threads of the arena that it is called in.
template <class Body>
void for_each_index(std::size_t count, Body&& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 64), [&](const tbb::blocked_range<std::size_t>& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) body(i);
  });
}

/// The same for few calls that each take long.
template <class Body>
void for_each_task(std::size_t count, Body&& body) {
  tbb::parallel_for(std::size_t{0}, count, body);
}

}  // namespace raymeter
