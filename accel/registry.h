#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "accel/slots.h"
#include "accel/technique.h"

namespace raymeter {

/// The tables of the slots, in the order of reports. The first row of first_hits() and of occlusions() is what a technique has that names none.
[[nodiscard]] std::span<const StructureEntry> structures() noexcept;
/// The same with the peers from outside behind them, whose answers are listed beside ours and not held to our conventions.
[[nodiscard]] std::span<const StructureEntry> structures_and_peers() noexcept;
[[nodiscard]] std::span<const FirstHitEntry> first_hits() noexcept;
[[nodiscard]] std::span<const OcclusionEntry> occlusions() noexcept;

/// These throw Error, with the nearest name, where there is no such row.
[[nodiscard]] const StructureEntry& structure_entry(std::string_view name);
[[nodiscard]] const FirstHitEntry& first_hit_entry(std::string_view name);
[[nodiscard]] const OcclusionEntry& occlusion_entry(std::string_view name);

/// What rows of all tables have in common.
struct TechniqueInfo {
  std::string_view slot;  ///< structure, first_hit or occlusion
  std::string_view name;
  std::string_view summary;
  std::string_view source;
  std::vector<ParamInfo> (*params)();
};
/// All rows, slot by slot.
[[nodiscard]] std::vector<TechniqueInfo> techniques();
/// Throws Error, with the nearest name, where there is none.
[[nodiscard]] TechniqueInfo technique_info(std::string_view name);

/// A technique as written on the command line: STRUCTURE[:key=value,...][+FIRST_HIT[:key=value,...]][+OCCLUSION[:key=value,...]].
struct TechniqueSpec {
  const StructureEntry* structure = nullptr;
  ParamValues params;  ///< resolved: all that mean something
  Chosen<FirstHitEntry> first_hit;
  Chosen<OcclusionEntry> occlusion;
};
/// Throws Error naming what is wrong, e.g. "grid:densty: unknown parameter; did you mean density?".
[[nodiscard]] TechniqueSpec parse_technique(std::string_view text);

/// "key=value,key=value".
[[nodiscard]] std::string params_text(const ParamValues& params);
/// "name", or "name:key=value,..." where there are parameters.
[[nodiscard]] std::string technique_text(std::string_view name, const ParamValues& params);
template <class Entry>
[[nodiscard]] std::string technique_text(const Chosen<Entry>& chosen) {
  return technique_text(chosen.entry->name, chosen.params);
}

}  // namespace raymeter
