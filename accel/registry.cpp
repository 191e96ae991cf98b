#include "accel/registry.h"

#include <array>
#include <charconv>
#include <string>

#include "accel/bvh/bvh.h"
#include "accel/grid/grid.h"
#include "accel/list/list.h"

namespace raymeter {

namespace {

// THE table: a new technique is one folder and one row here.
constexpr std::array kStructures{kListEntry, kBvhEntry, kGridEntry};

/// Reads a value as the type that the parameter has.
ParamValue parse_value(const ParamInfo& info, std::string_view text) {
  if (std::holds_alternative<bool>(info.default_value)) {
    if (text == "true" || text == "on" || text == "1") return true;
    if (text == "false" || text == "off" || text == "0") return false;
    return std::string(text);
  }
  const auto number = [&]<class T>(T value) -> ParamValue {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) return std::string(text);
    return value;
  };
  if (std::holds_alternative<std::int64_t>(info.default_value)) return number(std::int64_t{});
  if (std::holds_alternative<double>(info.default_value)) return number(0.0);
  return std::string(text);
}

}  // namespace

std::span<const StructureEntry> structures() noexcept { return kStructures; }

const StructureEntry& structure_entry(std::string_view name) {
  std::vector<std::string_view> names;
  for (const StructureEntry& entry : kStructures) {
    if (entry.name == name) return entry;
    names.push_back(entry.name);
  }
  const std::string near = nearest_word(name, names);
  throw Error("unknown technique '" + std::string(name) + "'; " +
              (near.empty() ? "see 'raymeter list techniques'" : "did you mean " + near + "?"));
}

TechniqueSpec parse_technique(std::string_view text) {
  if (const auto plus = text.find('+'); plus != std::string_view::npos) {
    throw Error(std::string(text) + ": unknown technique slot '" + std::string(text.substr(plus)) + "'");
  }
  const auto colon = text.find(':');
  const StructureEntry& entry = structure_entry(text.substr(0, colon));
  const std::vector<ParamInfo> infos = entry.params();
  ParamValues values;
  std::string_view rest = colon == std::string_view::npos ? std::string_view{} : text.substr(colon + 1);
  while (!rest.empty()) {
    const std::string_view item = rest.substr(0, rest.find(','));
    rest = item.size() == rest.size() ? std::string_view{} : rest.substr(item.size() + 1);
    const auto equals = item.find('=');
    if (equals == std::string_view::npos) throw Error(std::string(text) + ": expected key=value, got '" + std::string(item) + "'");
    const std::string_view key = item.substr(0, equals);
    ParamValue value = std::string(item.substr(equals + 1));
    for (const ParamInfo& info : infos) {
      if (info.key == key) value = parse_value(info, item.substr(equals + 1));
    }
    values.emplace_back(key, std::move(value));
  }
  try {
    return {&entry, entry.resolve(values)};
  } catch (const Error& error) {
    throw Error(std::string(entry.name) + ":" + error.what());
  }
}

}  // namespace raymeter
