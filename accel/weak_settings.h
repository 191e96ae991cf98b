#pragma once

#include <algorithm>

#include "accel/technique.h"

namespace raymeter {

/// The parameters whose defaults are proven to give right answers and whose other values need not: tests (core/geometry/weak_tests.h), when planes of cells are
/// crossed, how much of a list is tested. Of some of these, as of dda=divide, there is a proof too; they are listed like the rest.
inline constexpr std::string_view kTestParams[] = {"box_test",         "box_padding", "box_bounds", "reciprocal",     "triangle_test",
                                                   "triangle_epsilon", "sphere_test", "dda",        "most_candidates"};

/// Whether a setting's answers are listed rather than held to ours, bit for bit: those of a peer from outside, or of weak tests.
[[nodiscard]] inline bool answers_for_itself(const StructureEntry& entry, const ParamValues& values) {
  const std::vector<ParamInfo> infos = entry.params();
  const auto is_weak = [&](const auto& value) {
    const auto of_test = [&](const ParamInfo& info) { return info.key == value.first && info.default_value != value.second; };
    return std::ranges::count(kTestParams, value.first) != 0 && std::ranges::any_of(infos, of_test);
  };
  return entry.peer || std::ranges::any_of(values, is_weak);
}

}  // namespace raymeter
