#pragma once

#include <array>
#include <optional>
#include <string_view>

#include <nlohmann/json.hpp>

#include "core/stats/counters.h"

namespace raymeter {

/// Names of the events' sums, in the order of Event; the packet view of each has the suffix "_packets".
inline constexpr std::array<std::string_view, kEventCount> kCounterColumns{"node_visits", "leaf_visits", "empty_leaf_visits", "volume_tests",
                                                                           "prim_tests",  "prim_hits",   "cache_tests",       "cache_hits"};

[[nodiscard]] nlohmann::ordered_json to_json(const Counters& counters);
/// Throws nlohmann's exceptions where a sum is absent.
[[nodiscard]] Counters counters_from_json(const nlohmann::json& json);

/// Live lanes of all lanes executed, over node visits, volume and primitive tests; empty where none was executed.
[[nodiscard]] std::optional<double> simd_utilization(const Counters& counters, int simd_width) noexcept;

}  // namespace raymeter
