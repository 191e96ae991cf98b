#pragma once

#include "accel/bvh/quantised_layout.h"
#include "core/ray/trace_args.h"
#include "core/simd/isa_enum.h"
#include "core/stats/counters.h"

namespace raymeter {

/// Scratch memory of a single ray's traversal: its stack.
[[nodiscard]] constexpr std::size_t single_bytes(std::int32_t stack_capacity) noexcept {
  return (static_cast<std::size_t>(stack_capacity) + kWideChildren) * (sizeof(float) + sizeof(WideRef));
}

/// Traversal of an 8-wide hierarchy by one ray at a time.
template <Isa I, class Stats>
struct SingleKernel {
  static void closest(const WideBvhView& bvh, const TraceArgs& args, Counters* counters) noexcept;
  static void any(const WideBvhView& bvh, const TraceArgs& args, Counters* counters) noexcept;
  static void closest(const QuantisedBvhView& bvh, const TraceArgs& args, Counters* counters) noexcept;
  static void any(const QuantisedBvhView& bvh, const TraceArgs& args, Counters* counters) noexcept;
};

}  // namespace raymeter
