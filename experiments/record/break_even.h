#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/config/experiment.h"
#include "experiments/record/run_records.h"

namespace raymeter {

/// What a technique costs: a build once, and so much a ray.
struct Price {
  double build_ms = 0;
  double ns_per_ray = 0;
};

/// The number of rays from which on `price` costs less in all than `other`: n = (B1 - B2) / (c2 - c1) with builds B and times per ray c. "always" where there
/// is nothing to make good, "never" where it is not made good.
[[nodiscard]] std::string break_even(const Price& price, const Price& other);

/// Against the list without volumes in the cell's scene, rays and setting; empty where the run has none, or for that list itself.
[[nodiscard]] std::string break_even_with_list(const std::vector<Experiment>& cells, const Experiment& cell, const RunRecords& records);

/// Writes break_even.csv: each timed cell against each other one of its scene, rays and setting.
void write_break_even(const std::filesystem::path& folder, const std::vector<Experiment>& cells, const RunRecords& records);

}  // namespace raymeter
