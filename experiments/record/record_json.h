#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "experiments/record/run_records.h"

namespace raymeter {

[[nodiscard]] nlohmann::ordered_json to_json(const SceneRecord& record);
[[nodiscard]] nlohmann::ordered_json to_json(const BuildRecord& record);
[[nodiscard]] nlohmann::ordered_json to_json(const CheckRecord& record);
[[nodiscard]] nlohmann::ordered_json to_json(const SampleRecord& record);
[[nodiscard]] nlohmann::ordered_json to_json(const EndRecord& record);

/// Reads a line that one of the above made; false where it is none.
[[nodiscard]] bool add_record(const std::string& line, RunRecords& records);

}  // namespace raymeter
