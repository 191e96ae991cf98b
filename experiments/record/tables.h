#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "experiments/config/config.h"
#include "experiments/record/run_records.h"

namespace raymeter {

/// A cell with the hash of its scene: the cell_id of the tables. Without the scene's record the cell's own id.
[[nodiscard]] std::string cell_id(const Experiment& cell, const RunRecords& records);
/// The structure and those of its parameters that need a build of their own.
[[nodiscard]] std::string build_text(const Experiment& cell);
/// Times of the cell's samples in ns per ray, in the samples' order, or of one phase of its frames; none where its hits are wrong.
[[nodiscard]] std::vector<double> ns_per_ray(const RunRecords& records, const std::string& cell, const std::optional<FramePhase>& phase = {});

/// Derives every table and benchmark.json from the records; what was not measured is empty.
void write_tables(const std::filesystem::path& folder, const Config& config, const std::vector<Experiment>& cells, const RunRecords& records);

}  // namespace raymeter
