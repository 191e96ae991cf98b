#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/config/config.h"
#include "experiments/record/run_records.h"

namespace raymeter {

// What the tables are made from, and how each table makes the rows of one cell.

using Row = std::vector<std::string>;
using AddRow = std::function<void(Row)>;

/// What a row tells of: a cell's whole pass, or one phase of its frame.
struct RowPhase {
  std::string_view name;
  std::optional<FramePhase> part;
};

struct Source {
  const Config& config;
  const std::vector<Experiment>& cells;
  const RunRecords& records;
  std::vector<std::optional<std::size_t>> references;

  /// Null where there is none yet.
  [[nodiscard]] const CheckRecord* check(const Experiment& cell) const;
  [[nodiscard]] const SceneRecord* scene(const Experiment& cell) const;
  [[nodiscard]] const BuildRecord* build(const Experiment& cell) const;
  /// Closest or any; of images total, then each phase that did something.
  [[nodiscard]] std::vector<RowPhase> phases(const Experiment& cell) const;
  /// What was counted in a phase; null where nothing was.
  [[nodiscard]] const Counters* counters(const Experiment& cell, const RowPhase& phase) const;
  /// Rays of a phase that hit, or are blocked; empty where that is not known.
  [[nodiscard]] std::optional<std::int64_t> hits(const Experiment& cell, const RowPhase& phase) const;
};

/// Time and rays of a sample, or of a phase in it. Shading is shared out among all rays of the frame.
[[nodiscard]] PhaseSample part_of(const SampleRecord& sample, const std::optional<FramePhase>& part) noexcept;

[[nodiscard]] std::string number(double value);
[[nodiscard]] std::string number(std::int64_t value);
template <class T>
std::string number(const std::optional<T>& value) {
  return value ? number(*value) : std::string();
}
/// Node visits and primitive tests per ray, SIMD utilisation: what counters.csv and summary.csv share; empty where nothing was counted.
[[nodiscard]] Row counter_averages(const Experiment& cell, const Counters* counters);

// The fields behind the key columns, of one cell and phase.
void add_sample_rows(const Source& source, const Experiment& cell, const RowPhase& phase, const AddRow& add);
void add_build_rows(const Source& source, const Experiment& cell, const RowPhase& phase, const AddRow& add);
void add_counter_rows(const Source& source, const Experiment& cell, const RowPhase& phase, const AddRow& add);
void add_accuracy_rows(const Source& source, const Experiment& cell, const RowPhase& phase, const AddRow& add);
void add_frame_rows(const Source& source, const Experiment& cell, const RowPhase& phase, const AddRow& add);
void add_summary_rows(const Source& source, const Experiment& cell, const RowPhase& phase, const AddRow& add);

}  // namespace raymeter
