#pragma once

#include <nlohmann/json.hpp>

#include "accel/params.h"

namespace raymeter {

/// A parameter's value as the JSON value of the same type.
[[nodiscard]] inline nlohmann::json to_json(const ParamValue& value) {
  return std::visit([](const auto& v) { return nlohmann::json(v); }, value);
}

/// Parameters as one object.
[[nodiscard]] inline nlohmann::json to_json(const ParamValues& values) {
  nlohmann::json json = nlohmann::json::object();
  for (const auto& [key, value] : values) json[key] = to_json(value);
  return json;
}

}  // namespace raymeter
