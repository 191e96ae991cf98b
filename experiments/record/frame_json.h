#pragma once

#include <nlohmann/json.hpp>

#include "experiments/record/run_records.h"

namespace raymeter {

/// Numbers of rays by kind, as members of one object.
[[nodiscard]] nlohmann::ordered_json to_json(const RayCounts& rays);

[[nodiscard]] nlohmann::ordered_json to_json(const FrameRecord& record);
/// Throws nlohmann's exceptions where something is absent.
[[nodiscard]] FrameRecord frame_from_json(const nlohmann::json& json);

[[nodiscard]] nlohmann::ordered_json to_json(const PhaseSamples& phases);
[[nodiscard]] PhaseSamples phases_from_json(const nlohmann::json& json);

}  // namespace raymeter
