#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "core/ray/generators.h"
#include "core/scene/scene.h"

namespace raymeter {

/// A scene, rays, and what they are to meet there.
struct Problem {
  Scene scene;
  RaySet set;
};

/// A row of the table of hard cases: all that `list scenes`, the runner and the tests know of one. Scenes are named "hard:" and the case's name; their rays of
/// kind "case" are those of the case.
struct HardCase {
  std::string_view name;
  std::string_view summary;                        ///< what is hard about it
  Problem (*make)(int count, std::uint64_t seed);  ///< `count`: of rays, where they are at random; the scene depends on neither
  double t_ulp_max = 0;                            ///< promised error of t, where it is known by construction; in units of its last place
};

/// All cases, in the order of listings.
[[nodiscard]] std::span<const HardCase> hard_cases() noexcept;

/// The case of a scene's name, "hard:NAME". Throws Error, with the nearest name, where there is none.
[[nodiscard]] const HardCase& hard_case(std::string_view spec);

}  // namespace raymeter
