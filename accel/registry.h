#pragma once

#include <span>
#include <string_view>

#include "accel/technique.h"

namespace raymeter {

/// The table of structures, in the order of reports.
[[nodiscard]] std::span<const StructureEntry> structures() noexcept;
/// Throws Error, with the nearest name, where there is none.
[[nodiscard]] const StructureEntry& structure_entry(std::string_view name);

/// A technique as written on the command line: STRUCTURE[:key=value,...][+SLOT...].
struct TechniqueSpec {
  const StructureEntry* structure = nullptr;
  ParamValues params;  ///< resolved: all of them
};
/// Throws Error naming what is wrong, e.g. "grid:densty: unknown parameter; did you mean density?".
[[nodiscard]] TechniqueSpec parse_technique(std::string_view text);

}  // namespace raymeter
