#include "accel/registry.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <string>

#include "accel/bvh/bvh.h"
#include "accel/embree/embree.h"
#include "accel/grid/grid.h"
#include "accel/grid/recursive_grid.h"
#include "accel/kdtree/kdtree.h"
#include "accel/list/list.h"
#include "accel/octree/octree.h"
#include "accel/ray_classification/ray_classification.h"
#include "accel/shadow_cache/shadow_cache.h"
#include "accel/zbuffer/zbuffer.h"

namespace raymeter {

namespace {

// THE tables: a new technique is one folder and one row here. Peers stand last.
constexpr std::array kStructures{kListEntry,  kBvhEntry, kGridEntry, kRecursiveGridEntry, kOctreeEntry, kKdTreeEntry, kBspEntry, kRayClassificationEntry,
                                 kEmbreeEntry};
constexpr auto kOwnStructures = static_cast<std::size_t>(std::ranges::count(kStructures, false, &StructureEntry::peer));
constexpr std::array kFirstHits{kCastEntry, kZbufferEntry};
constexpr std::array kOcclusions{kNoneEntry, kShadowCacheEntry};

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

template <class Rows>
const auto& row_named(const Rows& rows, std::string_view name) {
  std::vector<std::string_view> names;
  for (const auto& row : rows) {
    if (row.name == name) return row;
    names.push_back(row.name);
  }
  const std::string near = nearest_word(name, names);
  throw Error("unknown technique '" + std::string(name) + "'; " + (near.empty() ? "see 'raymeter list techniques'" : "did you mean " + near + "?"));
}

template <class Row>
bool has_row(std::span<const Row> rows, std::string_view name) {
  return std::ranges::find(rows, name, &Row::name) != rows.end();
}

/// One slot of a technique's text.
struct SlotText {
  std::string_view name;
  std::string_view params;
};

/// Takes the first slot off `rest`. A plus separates slots where a name follows; others belong to numbers.
SlotText take_slot(std::string_view& rest) {
  std::size_t end = 0;
  while (end < rest.size() && !(rest[end] == '+' && end + 1 < rest.size() && std::isalpha(static_cast<unsigned char>(rest[end + 1])) != 0)) ++end;
  const std::string_view slot = rest.substr(0, end);
  rest.remove_prefix(std::min(rest.size(), end + 1));
  const auto colon = slot.find(':');
  return {slot.substr(0, colon), colon == std::string_view::npos ? std::string_view{} : slot.substr(colon + 1)};
}

/// A row's parameters as text says, all of them.
template <class Row>
ParamValues parse_params(const Row& row, std::string_view text) {
  const std::vector<ParamInfo> infos = row.params();
  ParamValues values;
  while (!text.empty()) {
    const std::string_view item = text.substr(0, text.find(','));
    text = item.size() == text.size() ? std::string_view{} : text.substr(item.size() + 1);
    const auto equals = item.find('=');
    if (equals == std::string_view::npos) throw Error(std::string(row.name) + ": expected key=value, got '" + std::string(item) + "'");
    const std::string_view key = item.substr(0, equals);
    ParamValue value = std::string(item.substr(equals + 1));
    for (const ParamInfo& info : infos) {
      if (info.key == key) value = parse_value(info, item.substr(equals + 1));
    }
    values.emplace_back(key, std::move(value));
  }
  try {
    const std::vector<ParamValues> resolved{row.resolve(values)};
    for (const auto& [key, value] : values) check_used(infos, key, value, resolved);
    return resolved.front();
  } catch (const Error& error) {
    throw Error(std::string(row.name) + ":" + error.what());
  }
}

/// Fills an empty slot.
template <class Row>
void choose(Chosen<Row>& slot, std::span<const Row> rows, const SlotText& text) {
  const Row& row = row_named(rows, text.name);
  if (slot.entry != nullptr) throw Error(std::string(text.name) + ": stands in the same slot as " + std::string(slot.entry->name));
  slot = {&row, parse_params(row, text.params)};
}

template <class Row>
void choose_default(Chosen<Row>& slot, std::span<const Row> rows) {
  if (slot.entry == nullptr) slot = {&rows.front(), rows.front().resolve({})};
}

}  // namespace

std::span<const StructureEntry> structures() noexcept { return std::span(kStructures).first<kOwnStructures>(); }
std::span<const StructureEntry> structures_and_peers() noexcept { return kStructures; }
std::span<const FirstHitEntry> first_hits() noexcept { return kFirstHits; }
std::span<const OcclusionEntry> occlusions() noexcept { return kOcclusions; }

const StructureEntry& structure_entry(std::string_view name) { return row_named(structures_and_peers(), name); }
const FirstHitEntry& first_hit_entry(std::string_view name) { return row_named(first_hits(), name); }
const OcclusionEntry& occlusion_entry(std::string_view name) { return row_named(occlusions(), name); }

std::vector<TechniqueInfo> techniques() {
  std::vector<TechniqueInfo> all;
  const auto add = [&](std::string_view slot, const auto& rows) {
    for (const auto& row : rows) all.push_back({slot, row.name, row.summary, row.source, row.params});
  };
  add("structure", structures_and_peers());
  add("first_hit", first_hits());
  add("occlusion", occlusions());
  return all;
}

TechniqueInfo technique_info(std::string_view name) {
  if (name.starts_with('+')) name.remove_prefix(1);  // as it stands behind a structure
  return row_named(techniques(), name);
}

TechniqueSpec parse_technique(std::string_view text) {
  std::string_view rest = text;
  TechniqueSpec spec;
  const SlotText structure = take_slot(rest);
  if (has_row(first_hits(), structure.name) || has_row(occlusions(), structure.name)) {
    throw Error(std::string(structure.name) + ": comes after a structure, as in bvh+" + std::string(structure.name));
  }
  spec.structure = &structure_entry(structure.name);
  spec.params = parse_params(*spec.structure, structure.params);
  while (!rest.empty()) {
    const SlotText slot = take_slot(rest);
    if (has_row(first_hits(), slot.name)) {
      choose(spec.first_hit, first_hits(), slot);
    } else if (has_row(occlusions(), slot.name)) {
      choose(spec.occlusion, occlusions(), slot);
    } else if (has_row(structures_and_peers(), slot.name)) {
      throw Error(std::string(slot.name) + ": stands in the same slot as " + std::string(structure.name));
    } else {
      (void)technique_info(slot.name);  // throws
    }
  }
  choose_default(spec.first_hit, first_hits());
  choose_default(spec.occlusion, occlusions());
  return spec;
}

std::string params_text(const ParamValues& params) {
  std::string text;
  for (const auto& [key, value] : params) text.append(text.empty() ? "" : ",").append(key).append("=").append(to_string(value));
  return text;
}

std::string technique_text(std::string_view name, const ParamValues& params) {
  return std::string(name).append(params.empty() ? "" : ":").append(params_text(params));
}

}  // namespace raymeter
