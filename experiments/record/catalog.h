#pragma once

#include <string>

#include "accel/registry.h"

namespace raymeter {

/// What there is to choose from, as JSON texts of one array each.
[[nodiscard]] std::string techniques_json();
[[nodiscard]] std::string scenes_json();
[[nodiscard]] std::string isas_json();
[[nodiscard]] std::string metrics_json();
/// One technique with its parameters, as a JSON object.
[[nodiscard]] std::string technique_json(const TechniqueInfo& technique);

}  // namespace raymeter
