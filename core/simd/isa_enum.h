#pragma once

#include <cstdint>

namespace raymeter {

/// Instruction sets a kernel is compiled for, in clusters; `scalar` is the honest baseline of a SIMD speed-up.
enum class Isa : std::uint8_t { scalar, sse42, avx2, avx512 };

}  // namespace raymeter
