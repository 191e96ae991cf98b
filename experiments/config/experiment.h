#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "accel/registry.h"
#include "core/render/termination.h"
#include "core/scene/camera.h"
#include "core/simd/isa.h"

namespace raymeter {

/// From where a scene is seen, and by what light, instead of what its file says.
struct SceneView {
  glm::dvec3 eye{0.0};
  glm::dvec3 look_at{0.0};
  glm::dvec3 up{0.0, 1.0, 0.0};
  double fov_degrees = 45;
  std::optional<glm::dvec3> light;  ///< empty: those of the file
};

/// A scene of the matrix.
struct SceneChoice {
  std::string name;  ///< what records show: the config's name for it, or its text with environment variables not substituted
  std::string spec;  ///< for load_scene
  std::optional<SceneView> view;
  std::string absent;  ///< why an optional scene is not there; its cells are skipped
};

/// What a cell traces: a ray set by its generator's name, "case" for that of a hard case, or as a .npy file with the query it is for, or "image", complete
/// frames.
struct RaysChoice {
  std::string name;  ///< as the config has it, numbers in their shortest form; "FILE:any" for a file's any-hit queries
  std::string file;  ///< path of a .npy file, empty for generated rays
  bool any = false;  ///< files only

  [[nodiscard]] bool image() const noexcept { return name == "image"; }
  /// Without the rule of origins that may follow.
  [[nodiscard]] std::string_view kind() const noexcept { return std::string_view(name).substr(0, name.find(':')); }
};

/// One cell of the matrix, fully resolved: what is measured. How often and how carefully is in Config.
struct Experiment {
  std::string id;  ///< hash of everything below but the specs and paths, and parameters at their defaults
  SceneChoice scene;
  const StructureEntry* structure = nullptr;
  ParamValues params;                       ///< the structure's, all that mean something beside each other
  Chosen<FirstHitEntry> first_hit;          ///< the default where the rays have no first hit of the eye: see takes_first_hit()
  Chosen<OcclusionEntry> occlusion;         ///< the default where the rays are no shadow rays: see takes_occlusion()
  int max_depth = Termination{}.max_depth;  ///< of frames; where ray sets are traced it stays as it is here
  double min_weight = 0;                    ///< likewise
  bool general = false;                     ///< likewise: frames run what any scene may need
  Isa isa = Isa::scalar;
  int packet = 1;
  RaysChoice rays;
  int threads = 1;  ///< 0: all
  CameraConvention camera = CameraConvention::pixel;
  int width = 0;  ///< pixels of the rays' camera
  int height = 0;
  std::uint64_t seed = 0;
};

/// Whether rays are eye rays, or contain some.
[[nodiscard]] bool takes_first_hit(const RaysChoice& rays) noexcept;
/// Whether rays are shadow rays, or contain some, that know their light and source. Ambient occlusion has no lights; rays of a file say nothing of theirs.
[[nodiscard]] bool takes_occlusion(const RaysChoice& rays) noexcept;

/// The technique as on the command line, all parameters included; slots that hold their default are left out.
[[nodiscard]] std::string technique_text(const Experiment& experiment);
[[nodiscard]] std::string threads_text(int threads);

/// What a cell has in a slot that the tables fill.
struct SlotField {
  std::string_view slot;
  std::string_view name;
  const ParamValues& params;
};
inline constexpr std::array<std::string_view, 3> kSlots{"structure", "first_hit", "occlusion"};
[[nodiscard]] std::array<SlotField, kSlots.size()> slot_fields(const Experiment& experiment) noexcept;

/// Keys that `exclude`, `measure.reference` and --filter may name: the fields of the matrix, and of every slot SLOT.name and SLOT.PARAM.
[[nodiscard]] std::vector<std::string> field_keys();
/// The text of a field, as the config writes it; empty where the experiment has no such field (another structure's parameter).
[[nodiscard]] std::optional<std::string> field(const Experiment& experiment, const std::string& key);

/// Fields and the texts each may have; all must match. A slot as a key means the name of what is in it, or that with its parameters; "structure" also the
/// whole technique.
struct Pattern {
  std::vector<std::pair<std::string, std::vector<std::string>>> fields;
  /// `glob`: the texts may hold * ? [...].
  [[nodiscard]] bool matches(const Experiment& experiment, bool glob = false) const;
  [[nodiscard]] bool names(std::string_view key) const noexcept;
};

/// Reads 'structure=bvh*;scene=spd:balls*'; throws Error for an unknown key.
[[nodiscard]] Pattern parse_filter(const std::string& text);

}  // namespace raymeter
