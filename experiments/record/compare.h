#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "experiments/record/statistics.h"

namespace raymeter {

/// One cell of two runs.
struct CellComparison {
  std::string what;             ///< for people
  std::optional<double> ratio;  ///< time of the new run against the base's, medians
  /// Covers the ratio of the true medians with at least 90 %: each run's median lies in its own interval with 95 %.
  std::optional<Interval> interval;
  std::vector<std::string> changed;  ///< counters, "hits", or defaults of parameters, that differ
};

struct RunComparison {
  std::vector<CellComparison> cells;  ///< that both runs have
  std::size_t only_base = 0;
  std::size_t only_new = 0;
  bool same_machine = true;
  std::optional<double> geomean;  ///< of the ratios
};

/// Compares two results folders cell by cell. Cells match by id, which says scene (its contents too), technique, rays and threads. Throws Error for a folder
/// without a run.
[[nodiscard]] RunComparison compare_runs(const std::filesystem::path& base, const std::filesystem::path& with);

}  // namespace raymeter
