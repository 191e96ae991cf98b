#pragma once

#include <cstddef>
#include <cstdint>

#include "core/ray/views.h"

namespace raymeter {

/// One call of a kernel: a slice of a batch. `packet` in 1..kMaxPacket; `scratch` has the bytes the structure asked for, 64-byte aligned.
struct TraceArgs {
  RayView rays;
  HitView hits;           ///< closest only
  std::int32_t* blocker;  ///< any only: a primitive that blocks ray i, -1 where it is free
  std::int32_t packet;
  std::byte* scratch;
};

}  // namespace raymeter
