#pragma once

#include <string>
#include <vector>

#include "experiments/cli/cli.h"
#include "experiments/config/expand.h"

namespace raymeter {

/// The flags by which a config becomes cells.
struct ConfigOptions {
  std::string path;
  std::vector<std::string> settings;
  std::string filter;
  std::string shard;

  void add_to(CLI::App& command);
  [[nodiscard]] Config load(const Cli& cli) const { return load_config(path, settings, cli.environment); }
  [[nodiscard]] std::vector<Experiment> cells(const Config& config) const;
};

/// The cells as a table for people, with a summary as last line.
[[nodiscard]] std::string plan_table(const Config& config, const std::vector<Experiment>& cells);

}  // namespace raymeter
