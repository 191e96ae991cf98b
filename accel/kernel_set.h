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

/// of<Isa>() for the wanted instruction set, `of` being a lambda without captures; made when compiling.
template <class Of>
[[nodiscard]] const auto& for_isa(Isa isa, Of) noexcept {
  static constexpr std::array all{Of{}.template operator()<Isa::scalar>(), Of{}.template operator()<Isa::sse42>(), Of{}.template operator()<Isa::avx2>(),
                                  Of{}.template operator()<Isa::avx512>()};
  return all[static_cast<std::size_t>(isa)];
}

/// Kernel<Isa, Stats> is a class template with static closest and any, defined only in its *_kernel.cpp, which is compiled once per instruction set.
template <template <Isa, class> class Kernel, class View>
[[nodiscard]] const KernelSet<View>& kernels_for(Isa isa) noexcept {
  return for_isa(isa, []<Isa I>() {
    return KernelSet<View>{Kernel<I, NoStats>::closest, Kernel<I, NoStats>::any, Kernel<I, CountStats>::closest, Kernel<I, CountStats>::any};
  });
}

}  // namespace raymeter
