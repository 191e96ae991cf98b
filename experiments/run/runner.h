#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "experiments/config/config.h"
#include "experiments/record/run_records.h"
#include "experiments/run/progress.h"
#include "experiments/run/stop.h"

namespace raymeter {

struct RunOptions {
  std::string out;  ///< results folder; empty: results/NAME/UTC_SHA_HOST
  bool resume = false;
  bool fresh = false;
  std::string pin = "auto";
  std::string command;  ///< as called, for the manifest
};

struct RunResult {
  std::filesystem::path folder;
  StopReason stopped = StopReason::none;
  bool nothing_to_do = false;
  /// An unfinished run of the same plan that was not continued.
  std::optional<std::filesystem::path> unfinished_run;
  std::map<Status, std::size_t> cells;  ///< how many ended how
  std::vector<std::string> complaints;  ///< one line for each cell that is not ok
};

/// Runs or continues an experiment and derives its tables. Throws Error for what the user can mend before any work (folder, machine, another run in the way),
/// std::runtime_error where writing fails: what was measured until then is safe in samples.jsonl.
[[nodiscard]] RunResult run_experiment(const Config& config, const std::vector<Experiment>& cells, const RunOptions& options, Progress& progress);

}  // namespace raymeter
