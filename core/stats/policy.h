#pragma once

#include "core/stats/counters.h"

namespace raymeter {

/// The timed kernels' policy: counting compiles to nothing. Policies receive the mask, never its popcount.
struct NoStats {
  static constexpr bool kCounting = false;
  explicit constexpr NoStats(Counters*) noexcept {}
  template <Event, class L>
  constexpr void count(const typename L::Mask&) const noexcept {}
};

/// The counted kernels' policy.
struct CountStats {
  static constexpr bool kCounting = true;
  Counters* out;
  explicit constexpr CountStats(Counters* counters) noexcept : out(counters) {}
  template <Event e, class L>
  void count(const typename L::Mask& live) const noexcept {
    out->rays[static_cast<std::size_t>(e)] += static_cast<std::uint64_t>(__builtin_popcount(L::bits(live)));
    out->packets[static_cast<std::size_t>(e)] += 1;
  }
};

}  // namespace raymeter
