#pragma once

// Events of a group's rays, in the counting kernels.

#include "accel/bvh/wide_layout.h"
#include "core/stats/policy.h"

namespace raymeter {

/// Counts an event for each of the rays, by registers of them.
template <Event e, class L, class Stats>
[[gnu::always_inline]] inline void count_rays(std::uint64_t rays, Stats stats) noexcept {
  if constexpr (Stats::kCounting) {
    constexpr std::uint32_t kAll = (1u << L::kWidth) - 1;
    for (; rays != 0; rays >>= L::kWidth) {
      const std::uint32_t lanes = static_cast<std::uint32_t>(rays) & kAll;
      if (lanes != 0) stats.template count<e, L>(L::mask(lanes));
    }
  }
}

template <class L, class Stats>
[[gnu::always_inline]] inline void count_node(std::uint64_t rays, Stats stats) noexcept {
  if constexpr (Stats::kCounting) {
    constexpr int kStep = L::kWidth < kWideChildren ? L::kWidth : kWideChildren;
    count_rays<Event::node_visit, L>(rays, stats);
    for (; rays != 0; rays &= rays - 1) {
      for (int c = 0; c < kWideChildren; c += kStep) stats.template count<Event::volume_test, L>(L::mask((1u << kStep) - 1));
    }
  }
}

}  // namespace raymeter
