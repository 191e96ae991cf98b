#pragma once

#include <string>
#include <vector>

#include "experiments/config/config.h"
#include "experiments/record/run_records.h"

namespace raymeter {

/// The samples in Google Benchmark's JSON schema: one iteration entry a sample, times in ms, counters as user counters.
[[nodiscard]] std::string google_benchmark_json(const std::vector<Experiment>& cells, const RunRecords& records);

}  // namespace raymeter
