#pragma once

#include <vector>

#include "accel/technique.h"
#include "accel/volumes.h"

namespace raymeter {

struct ListParams : VolumeParams {
  std::string volume = "none";
  std::string around = "primitive";

  static auto fields() {
    using Field = Param<ListParams>;
    std::vector<Field> fields{
        Field{"volume", &ListParams::volume, "bounding volume that is tested before an object", 0, 0, {"none", "sphere", "aabb", "obb", "kdop"}},
        where<ListParams>(
            [](const ListParams& p) { return p.volume != "none"; },
            Field{"around", &ListParams::around, "volumes: around each primitive, or each composite object of the scene", 0, 0, {"primitive", "object"}}),
    };
    const std::vector<Field> volume = volume_fields<ListParams>();
    fields.insert(fields.end(), volume.begin(), volume.end());
    return fields;
  }
};

/// As resolve_params; throws Error also where those of the volume contradict each other.
[[nodiscard]] ParamValues resolve_list(const ParamValues& values);

/// Adds the areas of the volumes.
void add_list_quality(const Scene& scene, const ParamValues& values, int threads, BuildStats& stats);
[[nodiscard]] std::unique_ptr<Structure> build_list(const Scene& scene, const ParamValues& values, int threads);

inline constexpr StructureEntry kListEntry{
    "list",
    "every ray against every object, optionally behind a bounding volume: the reference that all others are held against",
    "Whitted 1980, CACM 23(6)",
    param_infos<ListParams>,
    resolve_list,
    build_list,
    add_list_quality};

}  // namespace raymeter
