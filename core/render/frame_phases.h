#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/stats/counters.h"

namespace raymeter {

/// What the time of a frame is split into. The first four trace rays; shading is all the rest: making rays, surfaces and light, and adding up.
enum class FramePhase : std::uint8_t { first_hit, shadow, reflection, refraction, shading };
inline constexpr std::array kFramePhases{FramePhase::first_hit, FramePhase::shadow, FramePhase::reflection, FramePhase::refraction, FramePhase::shading};

[[nodiscard]] constexpr std::string_view name(FramePhase phase) noexcept {
  constexpr std::array<std::string_view, kFramePhases.size()> names{"first_hit", "shadow", "reflection", "refraction", "shading"};
  return names[static_cast<std::size_t>(phase)];
}

/// One phase's share of a frame. `counters` stay zero where the timed kernels trace.
struct PhaseTotals {
  double ms = 0;
  std::int64_t rays = 0;
  Counters counters;

  void add(const PhaseTotals& other) noexcept {
    ms += other.ms;
    rays += other.rays;
    counters.add(other.counters);
  }
};

/// Of every phase, by FramePhase.
struct FrameTotals {
  std::array<PhaseTotals, kFramePhases.size()> phase;

  [[nodiscard]] PhaseTotals& operator[](FramePhase p) noexcept { return phase[static_cast<std::size_t>(p)]; }
  [[nodiscard]] const PhaseTotals& operator[](FramePhase p) const noexcept { return phase[static_cast<std::size_t>(p)]; }
  [[nodiscard]] PhaseTotals sum() const noexcept {
    PhaseTotals all;
    for (const PhaseTotals& one : phase) all.add(one);
    return all;
  }
  void add(const FrameTotals& other) noexcept {
    for (std::size_t p = 0; p < phase.size(); ++p) phase[p].add(other.phase[p]);
  }
  /// Calls trace(counters or null), which traces so many rays, by the clock of a phase.
  template <class Trace>
  void measure(FramePhase p, std::size_t rays, bool count, Trace&& trace) {
    PhaseTotals& totals = (*this)[p];
    const auto start = std::chrono::steady_clock::now();
    trace(count ? &totals.counters : nullptr);
    totals.ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    totals.rays += static_cast<std::int64_t>(rays);
  }
};

}  // namespace raymeter
