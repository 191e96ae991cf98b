#pragma once

#include <cstdint>

#include "core/scene/primitive.h"

namespace raymeter {

/// `count` consecutive primitives of one kind, from `first` on: what a leaf holds. A leaf of several kinds has several runs.
struct PrimitiveRun {
  static constexpr int kCountBits = 28;
  std::uint32_t kind_and_count = 0;
  std::int32_t first = 0;

  [[nodiscard]] constexpr PrimKind kind() const noexcept { return static_cast<PrimKind>(kind_and_count >> kCountBits); }
  [[nodiscard]] constexpr std::int32_t count() const noexcept { return static_cast<std::int32_t>(kind_and_count & ((1u << kCountBits) - 1)); }
};

[[nodiscard]] constexpr PrimitiveRun primitive_run(PrimKind kind, std::int32_t first, std::int32_t count) noexcept {
  return {static_cast<std::uint32_t>(kind) << PrimitiveRun::kCountBits | static_cast<std::uint32_t>(count), first};
}

}  // namespace raymeter
