#pragma once

#include <nlohmann/json.hpp>

#include "accel/technique.h"

namespace raymeter {

/// A structure's quality, with the names of builds.csv; what does not apply is null.
[[nodiscard]] nlohmann::ordered_json to_json(const BuildStats& stats);
[[nodiscard]] BuildStats build_stats_from_json(const nlohmann::json& json);

}  // namespace raymeter
