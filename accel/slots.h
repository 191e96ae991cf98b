#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "accel/technique.h"
#include "core/render/first_hit.h"
#include "core/render/occlusion.h"

namespace raymeter {

/// How a slot's technique is to work.
struct SlotOptions {
  Isa isa = Isa::scalar;
  int packet = 1;      ///< rays per packet, 1..kMaxPacket
  int threads = 0;     ///< at most, while it is made; 0: all
  ParamValues params;  ///< all of the technique's
};

/// A row of the table of first hits. What it makes refers to the scene and to the intersector, which answers what the technique leaves to rays.
struct FirstHitEntry {
  std::string_view name;
  std::string_view summary;
  std::string_view source;  ///< who, when, where
  std::vector<ParamInfo> (*params)();
  /// All parameters with their values, or Error.
  ParamValues (*resolve)(const ParamValues& values);
  std::unique_ptr<FirstHit> (*make)(const Scene& scene, const SlotOptions& options, Intersector& intersector);
};

/// A row of the table of occlusions; as above.
struct OcclusionEntry {
  std::string_view name;
  std::string_view summary;
  std::string_view source;
  std::vector<ParamInfo> (*params)();
  ParamValues (*resolve)(const ParamValues& values);
  std::unique_ptr<Occlusion> (*make)(const Scene& scene, const SlotOptions& options, Intersector& intersector);
};

/// A row with all of its parameters.
template <class Entry>
struct Chosen {
  const Entry* entry = nullptr;
  ParamValues params;
  friend bool operator==(const Chosen&, const Chosen&) = default;
};

/// Of techniques without parameters.
[[nodiscard]] inline std::vector<ParamInfo> no_params() { return {}; }
[[nodiscard]] inline ParamValues resolve_no_params(const ParamValues& values) {
  if (!values.empty()) params_detail::unknown_key(values.front().first, {});
  return {};
}

inline constexpr FirstHitEntry kCastEntry{
    "cast",
    "eye rays are traced as all others",
    "Whitted 1980, CACM 23(6)",
    no_params,
    resolve_no_params,
    [](const Scene&, const SlotOptions&, Intersector& intersector) -> std::unique_ptr<FirstHit> { return std::make_unique<CastFirstHit>(intersector); }};

inline constexpr OcclusionEntry kNoneEntry{
    "none",
    "shadow rays are traced as all others",
    "Whitted 1980, CACM 23(6)",
    no_params,
    resolve_no_params,
    [](const Scene&, const SlotOptions&, Intersector& intersector) -> std::unique_ptr<Occlusion> { return std::make_unique<TracedOcclusion>(intersector); }};

}  // namespace raymeter
