#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/config/experiment.h"

namespace raymeter {

inline constexpr int kSchemaVersion = 1;

/// A technique of one of the matrix's slots, with the values that each of its parameters is to take; parameters that are not named keep their defaults.
template <class Entry>
struct TechniqueAxis {
  const Entry* entry = nullptr;
  std::vector<std::pair<std::string, std::vector<ParamValue>>> params;
  std::string path;  ///< in the config, for messages
};

/// The axes whose product is measured.
struct Matrix {
  std::vector<SceneChoice> scene;
  std::vector<TechniqueAxis<StructureEntry>> structure;
  std::vector<TechniqueAxis<FirstHitEntry>> first_hit{{&first_hits().front(), {}, "matrix.first_hit"}};
  std::vector<TechniqueAxis<OcclusionEntry>> occlusion{{&occlusions().front(), {}, "matrix.occlusion"}};
  std::vector<int> max_depth{5};
  std::vector<double> min_weight{0};
  std::vector<bool> general{false};
  std::vector<Isa> isa{best_isa()};
  std::vector<int> packet{16};
  std::vector<RaysChoice> rays{{"primary", "", false}};
  std::vector<int> threads{1};
};

struct MeasureOptions {
  int warmup = 1;
  int samples = 15;         ///< timed passes per cell; 0 counts only
  int builds = 1;           ///< timed builds of each structure
  double max_time_s = 600;  ///< of the whole run; what is left then can be resumed
  double timeout_s = 120;   ///< of one cell: its counted, warm-up and timed passes
  Pattern reference;        ///< fields that a cell's reference differs in; empty: the first structure
};

struct VerifyOptions {
  bool oracle = true;
  bool cells = false;           ///< hold the cells that rays walk through against exact ones, too
  double max_tests = 1e9;       ///< ray-primitive tests, or cells of rays, of one exact verification
  double hit_mismatch_max = 0;  ///< share of the rays that may be wrong
};

/// A validated experiment description.
struct Config {
  std::string path;
  std::string text;  ///< the effective JSON, settings included, canonical
  std::string name;
  std::uint64_t seed = 1;
  Matrix matrix;
  std::vector<Pattern> exclude;
  CameraConvention camera = CameraConvention::pixel;
  int width = 512;
  int height = 512;
  MeasureOptions measure;
  VerifyOptions verify;
};

using Environment = std::function<const char*(const std::string&)>;

/// Reads, overrides ("measure.samples=3", "matrix.packet=[1,8]") and validates a config. Throws Error: "<path>: <JSON path>: what, what was expected".
[[nodiscard]] Config load_config(const std::string& path, const std::vector<std::string>& settings, const Environment& environment);
/// The same from a text; `name` stands for the path.
[[nodiscard]] Config parse_config(std::string_view text, const std::string& name, const std::vector<std::string>& settings, const Environment& environment);

}  // namespace raymeter
