#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "accel/technique.h"
#include "core/render/whitted.h"
#include "core/stats/counters.h"
#include "core/trace/on_demand.h"
#include "experiments/image/image_error.h"

namespace raymeter {

// What a run writes down as it goes, one JSON line each, in samples.jsonl; every table is derived from these.

/// How a cell ended. `refused`: its parameters do not suit its scene. `unfinished` is never written: it is the lack of anything else.
enum class Status : std::uint8_t { ok, wrong, skipped, timeout, failed, refused, unfinished };
[[nodiscard]] std::string_view name(Status status) noexcept;

struct SceneRecord {
  std::string scene;
  std::string hash;
  std::int32_t num_prims = 0;
  std::string needs;  ///< primitive kinds and material properties that it has, separated by spaces
  std::size_t scene_bytes = 0;
  double load_ms = 0;
};

/// The builds of one structure, which serves all cells of the scene with the same build parameters; in samples.jsonl a line for each.
struct BuildRecord {
  std::string scene;
  std::string build;             ///< the structure and those of its parameters that a build needs
  int threads = 1;               ///< as in the matrix: 0 is all
  std::vector<double> build_ms;  ///< of each build, at least one
  BuildStats stats;              ///< the same for all
};

/// What the truth says of the cells that rays walked through; see CellAccuracy in experiments/verify.
struct CellRecord {
  std::int64_t rays_checked = 0;
  std::int64_t rays_missing = 0;
  std::int64_t rays_at_risk = 0;
  std::int64_t cells_missed = 0;
  double longest = 0;
};

/// What verification found; see Accuracy in experiments/verify.
struct AccuracyRecord {
  std::int64_t rays_checked = 0;
  std::int64_t false_miss = 0;
  std::int64_t false_hit = 0;
  std::int64_t wrong_prim = 0;
  std::optional<std::int64_t> self_hits;
  std::optional<double> t_ulp_p50, t_ulp_p99, t_ulp_max;
};

/// What one frame consists of and how far it is from the one that is cut nowhere (min_weight 0, same max_depth).
struct FrameRecord {
  RayCounts rays;
  DepthCounts depth;
  std::array<Counters, kFramePhases.size()> counters;  ///< by phase
  std::int64_t rays_full = 0;                          ///< of the frame that is cut nowhere
  ImageError error;
  BoundCheck bound;
};

/// What a technique made on demand in the first pass over a cell's rays, which is the counted one.
struct DemandRecord {
  double first_prepare_ms = 0;  ///< when it had everything to make
  DemandStats stats;
};

/// A cell before its timed passes: verified and counted, or why not.
struct CheckRecord {
  std::string cell;
  Status status = Status::ok;
  std::string reason;  ///< empty where ok
  std::optional<std::int64_t> rays;
  int threads = 1;       ///< that ran, "all" resolved
  std::string hit_hash;  ///< of hits or pixels, or of which rays are blocked; empty where not traced
  std::optional<std::int64_t> hit_mismatch;
  std::string choice;  ///< what the technique settled on by looking at the rays, see Intersector
  std::optional<Counters> counters;
  std::optional<AccuracyRecord> accuracy;
  std::optional<FrameRecord> frame;  ///< of images
  std::optional<std::int64_t> hits;  ///< of ray sets: rays that hit, or are blocked
  std::optional<DemandRecord> demand{};
  std::optional<CellRecord> cells{};  ///< where it was asked for and rays walk
};

/// A phase's part of one timed frame.
struct PhaseSample {
  double ms = 0;
  std::int64_t rays = 0;
};
using PhaseSamples = std::array<PhaseSample, kFramePhases.size()>;

struct SampleRecord {
  std::string cell;
  int sample = 0;
  std::int64_t order_index = 0;
  double prepare_ms = 0;
  double trace_ms = 0;  ///< prepare included
  double cpu_ms = 0;    ///< processor time of all threads meanwhile
  std::int64_t rays = 0;
  bool ok = true;                        ///< whether the hits were the verified ones
  std::optional<PhaseSamples> phases{};  ///< of images
};

/// A cell that ends without all of its samples.
struct EndRecord {
  std::string cell;
  Status status = Status::timeout;
  std::string reason;
};

/// Everything that samples.jsonl holds.
struct RunRecords {
  std::map<std::string, SceneRecord> scenes;
  std::map<std::tuple<std::string, std::string, int>, BuildRecord> builds;  ///< by scene, build and threads
  std::map<std::string, CheckRecord> checks;
  std::map<std::string, std::map<int, SampleRecord>> samples;  ///< by cell and number
  std::map<std::string, EndRecord> ends;
  std::int64_t sample_count = 0;

  /// How the cell stands when `wanted` samples are to be taken.
  [[nodiscard]] Status status(const std::string& cell, int wanted) const;
  /// Why, where it is not ok.
  [[nodiscard]] std::string reason(const std::string& cell) const;
  [[nodiscard]] int samples_of(const std::string& cell) const;

  void add(const SceneRecord& record) { scenes[record.scene] = record; }
  /// Adds its builds to those that are known.
  void add(const BuildRecord& record);
  void add(const CheckRecord& record) { checks[record.cell] = record; }
  void add(const SampleRecord& record);
  void add(const EndRecord& record) { ends[record.cell] = record; }
};

}  // namespace raymeter
