#pragma once

#include <cstdint>
#include <type_traits>

namespace raymeter {

/// `first ? a : b` without a branch that a compiler might make of it: for conditions that nothing foresees.
template <class T>
requires std::is_integral_v<T>
[[nodiscard, gnu::always_inline]] inline T select_unforeseen(bool first, T a, T b) noexcept {
  return static_cast<T>(b ^ ((a ^ b) & static_cast<T>(-static_cast<T>(first))));
}
template <class T>
[[nodiscard, gnu::always_inline]] inline const T* select_unforeseen(bool first, const T* a, const T* b) noexcept {
  return reinterpret_cast<const T*>(select_unforeseen(first, reinterpret_cast<std::uintptr_t>(a), reinterpret_cast<std::uintptr_t>(b)));
}

}  // namespace raymeter
