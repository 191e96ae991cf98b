#include "core/base/threads.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>

namespace raymeter {
namespace {

TEST(OnThreads, HasAsManyThreadsAsAskedFor) {
  for (const int threads : {1, 2, 3, all_threads()}) {
    EXPECT_EQ(on_threads(threads, [] { return tbb::this_task_arena::max_concurrency(); }), threads);
    EXPECT_EQ(on_threads(threads, [] { return on_threads(1, [] { return tbb::this_task_arena::max_concurrency(); }); }), 1);
  }
  EXPECT_EQ(on_threads(0, [] { return tbb::this_task_arena::max_concurrency(); }), all_threads());
}

/// A thread that waits within a task for threads of its own must not begin another of the tasks around it: it may hold what that waits for.
TEST(OnThreads, TakesNoWorkFromAroundItWhereTheArenaServesAlready) {
  for (const int threads : {1, 2, 3}) {
    std::atomic<int> begun_within{0};
    std::atomic<int> calls{0};
    on_threads(threads, [&] {
      for_each_task(64, [&](std::size_t) {
        static thread_local bool waits = false;
        if (waits) ++begun_within;
        waits = true;
        on_threads(threads, [&] { for_each_task(32, [&](std::size_t) { ++calls; }); });
        waits = false;
      });
    });
    EXPECT_EQ(begun_within, 0);
    EXPECT_EQ(calls, 64 * 32);
  }
}

TEST(OnThreads, PassesExceptionsOn) {
  const auto fail = [] { throw std::runtime_error("no"); };
  EXPECT_THROW(on_threads(2, [&] { on_threads(2, fail); }), std::runtime_error);
}

}  // namespace
}  // namespace raymeter
