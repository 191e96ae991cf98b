#include "experiments/config/experiment.h"

#include <algorithm>

#include <fnmatch.h>

#include <fmt/format.h>

#include "accel/registry.h"
#include "core/base/error.h"

namespace raymeter {

namespace {

constexpr std::string_view kStructurePrefix = "structure.";

bool text_matches(const std::string& pattern, const std::string& text, bool glob) {
  return glob ? ::fnmatch(pattern.c_str(), text.c_str(), 0) == 0 : pattern == text;
}

bool field_matches(const Experiment& experiment, const std::string& key, const std::string& pattern, bool glob) {
  if (key == "structure") {
    return text_matches(pattern, std::string(experiment.structure->name), glob) || text_matches(pattern, technique_text(experiment), glob);
  }
  const std::optional<std::string> text = field(experiment, key);
  return text && text_matches(pattern, *text, glob);
}

}  // namespace

std::string params_text(const ParamValues& params) {
  std::string text;
  for (const auto& [key, value] : params) text += fmt::format("{}{}={}", text.empty() ? "" : ",", key, to_string(value));
  return text;
}

std::string technique_text(const Experiment& experiment) {
  const std::string params = params_text(experiment.params);
  return std::string(experiment.structure->name) + (params.empty() ? "" : ":" + params);
}

std::string threads_text(int threads) { return threads == 0 ? "all" : std::to_string(threads); }

std::vector<std::string> field_keys() {
  std::vector<std::string> keys{"scene",      "structure", "structure.name", "first_hit", "occlusion", "max_depth",
                                "min_weight", "isa",       "packet",         "rays",      "threads"};
  for (const StructureEntry& entry : structures()) {
    for (const ParamInfo& info : entry.params()) {
      const std::string key = std::string(kStructurePrefix) + std::string(info.key);
      if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
    }
  }
  return keys;
}

std::optional<std::string> field(const Experiment& e, const std::string& key) {
  if (key == "scene") return e.scene.name;
  if (key == "structure" || key == "structure.name") return std::string(e.structure->name);
  if (key == "first_hit") return e.first_hit;
  if (key == "occlusion") return e.occlusion;
  if (key == "max_depth") return std::to_string(e.max_depth);
  if (key == "min_weight") return to_string(ParamValue(e.min_weight));
  if (key == "isa") return std::string(name(e.isa));
  if (key == "packet") return std::to_string(e.packet);
  if (key == "rays") return e.rays.name;
  if (key == "threads") return threads_text(e.threads);
  for (const auto& [param, value] : e.params) {
    if (key == std::string(kStructurePrefix) + param) return to_string(value);
  }
  return std::nullopt;
}

bool Pattern::matches(const Experiment& experiment, bool glob) const {
  return std::all_of(fields.begin(), fields.end(), [&](const auto& wanted) {
    return std::any_of(wanted.second.begin(), wanted.second.end(),
                       [&](const std::string& pattern) { return field_matches(experiment, wanted.first, pattern, glob); });
  });
}

bool Pattern::names(std::string_view key) const noexcept {
  return std::any_of(fields.begin(), fields.end(), [&](const auto& wanted) { return wanted.first == key; });
}

Pattern parse_filter(const std::string& text) {
  const std::vector<std::string> keys = field_keys();
  const std::vector<std::string_view> known(keys.begin(), keys.end());
  Pattern pattern;
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::string_view item = rest.substr(0, rest.find(';'));
    rest.remove_prefix(std::min(rest.size(), item.size() + 1));
    if (item.empty()) continue;
    const std::size_t equals = item.find('=');
    if (equals == std::string_view::npos) throw Error(fmt::format("--filter: expected KEY=PATTERN, got '{}'", item));
    const std::string_view key = item.substr(0, equals);
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      const std::string near = nearest_word(key, known);
      throw Error(fmt::format("--filter: unknown key '{}'; {}", key,
                              near.empty() ? fmt::format("expected one of {}", fmt::join(known, ", ")) : "did you mean " + near + "?"));
    }
    pattern.fields.push_back({std::string(key), {std::string(item.substr(equals + 1))}});
  }
  return pattern;
}

}  // namespace raymeter
