#include "core/simd/isa.h"

namespace raymeter {

namespace {
constexpr std::array<std::string_view, kIsas.size()> kNames{"scalar", "sse42", "avx2", "avx512"};
}

std::string_view name(Isa isa) noexcept { return kNames[static_cast<std::size_t>(isa)]; }

std::optional<Isa> isa_from_name(std::string_view name) noexcept {
  for (const Isa isa : kIsas) {
    if (kNames[static_cast<std::size_t>(isa)] == name) return isa;
  }
  return std::nullopt;
}

// __builtin_cpu_supports also checks that the operating system saves the registers, which xsimd 8.1.0 does not.
bool available(Isa isa) noexcept {
  switch (isa) {
    case Isa::scalar: return true;
    case Isa::sse42: return __builtin_cpu_supports("sse4.2") != 0;
    case Isa::avx2: return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0 && __builtin_cpu_supports("bmi2") != 0;
    case Isa::avx512:
      return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512vl") != 0 &&
             __builtin_cpu_supports("avx512bw") != 0 && __builtin_cpu_supports("avx512cd") != 0;
  }
  return false;
}

Isa best_isa() noexcept {
  Isa best = Isa::scalar;
  for (const Isa isa : kIsas) {
    if (available(isa)) best = isa;
  }
  return best;
}

}  // namespace raymeter
