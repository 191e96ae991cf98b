#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace raymeter {

/// The config's JSON Schema, draft-07, from the tables of structures and instruction sets.
[[nodiscard]] nlohmann::ordered_json config_schema();
[[nodiscard]] std::string config_schema_text();

/// Throws Error, "<JSON path>: what, what was expected", where the schema does not allow the document.
void check_schema(const nlohmann::json& document);

/// The first thing in `value` that breaks `schema`, in words; empty where nothing is found.
[[nodiscard]] std::string explain(const nlohmann::json& value, const nlohmann::json& schema, const std::string& path);

}  // namespace raymeter
