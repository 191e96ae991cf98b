#include "experiments/config/experiment.h"

#include <algorithm>

#include <fnmatch.h>

#include <fmt/format.h>

#include "core/base/error.h"

namespace raymeter {

namespace {

/// "slot.key".
std::string slot_key(std::string_view slot, std::string_view key) { return fmt::format("{}.{}", slot, key); }

bool text_matches(const std::string& pattern, const std::string& text, bool glob) {
  return glob ? ::fnmatch(pattern.c_str(), text.c_str(), 0) == 0 : pattern == text;
}

bool field_matches(const Experiment& experiment, const std::string& key, const std::string& pattern, bool glob) {
  for (const SlotField& field : slot_fields(experiment)) {
    if (key != field.slot) continue;
    if (text_matches(pattern, std::string(field.name), glob) || text_matches(pattern, technique_text(field.name, field.params), glob)) return true;
    return key == "structure" && text_matches(pattern, technique_text(experiment), glob);
  }
  const std::optional<std::string> text = field(experiment, key);
  return text && text_matches(pattern, *text, glob);
}

}  // namespace

bool takes_first_hit(const RaysChoice& rays) noexcept { return rays.name == "primary" || rays.image(); }
bool takes_occlusion(const RaysChoice& rays) noexcept { return rays.name == "shadow" || rays.image(); }

std::string technique_text(const Experiment& e) {
  std::string text = technique_text(e.structure->name, e.params);
  if (e.first_hit.entry != &first_hits().front()) text.append("+").append(technique_text(e.first_hit));
  if (e.occlusion.entry != &occlusions().front()) text.append("+").append(technique_text(e.occlusion));
  return text;
}

std::string threads_text(int threads) { return threads == 0 ? "all" : std::to_string(threads); }

std::array<SlotField, kSlots.size()> slot_fields(const Experiment& e) noexcept {
  return {SlotField{kSlots[0], e.structure->name, e.params}, SlotField{kSlots[1], e.first_hit.entry->name, e.first_hit.params},
          SlotField{kSlots[2], e.occlusion.entry->name, e.occlusion.params}};
}

std::vector<std::string> field_keys() {
  std::vector<std::string> keys{"scene", "max_depth", "min_weight", "needs", "isa", "packet", "rays", "threads"};
  const auto add = [&](const std::string& key) {
    if (std::ranges::find(keys, key) == keys.end()) keys.push_back(key);
  };
  for (const TechniqueInfo& technique : techniques()) {
    add(std::string(technique.slot));
    add(slot_key(technique.slot, "name"));
    for (const ParamInfo& info : technique.params()) add(slot_key(technique.slot, info.key));
  }
  return keys;
}

std::optional<std::string> field(const Experiment& e, const std::string& key) {
  if (key == "scene") return e.scene.name;
  if (key == "max_depth") return std::to_string(e.max_depth);
  if (key == "min_weight") return to_string(ParamValue(e.min_weight));
  if (key == "needs") return e.general ? "all" : "auto";
  if (key == "isa") return std::string(name(e.isa));
  if (key == "packet") return std::to_string(e.packet);
  if (key == "rays") return e.rays.name;
  if (key == "threads") return threads_text(e.threads);
  for (const SlotField& field : slot_fields(e)) {
    if (key == field.slot || key == slot_key(field.slot, "name")) return std::string(field.name);
    for (const auto& [param, value] : field.params) {
      if (key == slot_key(field.slot, param)) return to_string(value);
    }
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
