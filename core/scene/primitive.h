#pragma once

#include <cstddef>
#include <cstdint>

namespace raymeter {

/// Primitive kinds; a cylinder is a cone of equal radii.
enum class PrimKind : std::uint8_t { sphere, triangle, polygon, cone };
inline constexpr std::size_t kPrimKindCount = 4;

/// Where a primitive lives: kind and index in the pool of that kind.
struct PrimRef {
  static constexpr std::uint32_t kDropped = 7;  ///< the kind of a primitive that was invalid and is in no pool
  std::uint32_t kind_bits : 3;
  std::uint32_t index : 29;

  [[nodiscard]] constexpr bool dropped() const noexcept { return kind_bits == kDropped; }
  [[nodiscard]] constexpr PrimKind kind() const noexcept { return static_cast<PrimKind>(kind_bits); }
  friend constexpr bool operator==(PrimRef, PrimRef) = default;
};
[[nodiscard]] constexpr PrimRef prim_ref(PrimKind kind, std::size_t index) noexcept {
  return {static_cast<std::uint32_t>(kind) & 7u, static_cast<std::uint32_t>(index) & 0x1FFFFFFFu};
}

}  // namespace raymeter
