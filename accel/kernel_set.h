#pragma once

#include <array>

#include "core/ray/trace_args.h"
#include "core/simd/isa.h"
#include "core/stats/counters.h"
#include "core/stats/policy.h"

namespace raymeter {

/// The four functions that a technique's kernel offers on one instruction set.
template <class View>
struct KernelSet {
  using Function = void (*)(const View&, const TraceArgs&, Counters*) noexcept;
  Function timed_closest;
  Function timed_any;
  Function counted_closest;
  Function counted_any;
};

/// Kernel<Isa, Stats> is a class template with static closest and any, defined only in its *_kernel.cpp, which is compiled once per instruction set.
template <template <Isa, class> class Kernel, class View>
[[nodiscard]] const KernelSet<View>& kernels_for(Isa isa) noexcept {
  static constexpr auto set = []<Isa I>() {
    return KernelSet<View>{Kernel<I, NoStats>::closest, Kernel<I, NoStats>::any, Kernel<I, CountStats>::closest, Kernel<I, CountStats>::any};
  };
  static constexpr std::array sets{set.template operator()<Isa::scalar>(), set.template operator()<Isa::sse42>(), set.template operator()<Isa::avx2>(),
                                   set.template operator()<Isa::avx512>()};
  return sets[static_cast<std::size_t>(isa)];
}

}  // namespace raymeter
