#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace raymeter {

/// JSON with comments; throws Error with the line for what is broken, and for a key that stands twice in one object.
[[nodiscard]] nlohmann::json load_json(std::string_view text);

/// Applies "measure.samples=3" or "matrix.structure[1].density=[2,4]"; the value is JSON, else a text. Objects that are not there are made.
void apply_setting(nlohmann::json& document, const std::string& setting);

}  // namespace raymeter
