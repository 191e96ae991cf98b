#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "core/simd/isa_enum.h"

namespace raymeter {

inline constexpr std::array kIsas{Isa::scalar, Isa::sse42, Isa::avx2, Isa::avx512};

/// Rays that one register of the instruction set holds.
[[nodiscard]] constexpr int simd_width(Isa isa) noexcept {
  constexpr std::array widths{1, 4, 8, 16};
  return widths[static_cast<std::size_t>(isa)];
}

[[nodiscard]] std::string_view name(Isa isa) noexcept;
[[nodiscard]] std::optional<Isa> isa_from_name(std::string_view name) noexcept;
/// Whether this CPU and its operating system run it.
[[nodiscard]] bool available(Isa isa) noexcept;
[[nodiscard]] Isa best_isa() noexcept;

}  // namespace raymeter
