#pragma once

#include <array>

#include "accel/technique.h"

namespace raymeter {

struct ListParams {
  static std::array<Param<ListParams>, 0> fields() { return {}; }
};

[[nodiscard]] std::unique_ptr<Structure> build_list(const Scene& scene, const ParamValues& values, int threads);

inline constexpr StructureEntry kListEntry{
    "list", "every ray against every primitive: the reference that all others are held against", "Whitted 1980, CACM 23(6)",
    param_infos<ListParams>, resolve_params<ListParams>, build_list};

}  // namespace raymeter
