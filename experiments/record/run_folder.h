#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "experiments/config/config.h"

namespace raymeter {

/// manifest.json: what a results folder is, and how far its run came.
struct Manifest {
  std::string name;
  std::string plan;    ///< hash of the cells and of how they are measured: only a run of the same plan may continue
  std::string state;   ///< running, interrupted, complete
  std::string config;  ///< path
  std::string config_text;
  std::string command;  ///< that began it
  std::string begun_utc;
  std::string ended_utc;  ///< empty while it runs
  std::string host, cpu, git_sha;
  bool git_dirty = false;
  std::size_t cells = 0;
};

/// The hash of Manifest::plan.
[[nodiscard]] std::string plan_hash(const Config& config, const std::vector<Experiment>& cells);

[[nodiscard]] std::optional<Manifest> read_manifest(const std::filesystem::path& folder);
/// Replaces the whole file at once.
void write_manifest(const std::filesystem::path& folder, const Manifest& manifest);

/// Whether this machine and build may add to a run: empty, or why not.
[[nodiscard]] std::string why_not_continued(const Manifest& manifest);
/// The newest folder below results/NAME with a run of this plan that may be continued here: an unfinished one if there is any, else a complete one.
[[nodiscard]] std::optional<std::filesystem::path> newest_run(const std::string& name, const std::string& plan);
/// results/NAME/UTC_SHA_HOST.
[[nodiscard]] std::filesystem::path new_run_path(const std::string& name);
/// Makes a results folder where there is none, and keeps other processes from running in it until destroyed.
class RunFolder {
public:
  /// Throws Error where the folder cannot be made or written, or another process runs in it.
  explicit RunFolder(const std::filesystem::path& path);
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

private:
  int descriptor_ = -1;
};

/// Removes what a run has written there, and nothing else.
void clear_run_folder(const std::filesystem::path& folder);
/// The same, and the folder and its parent where they are empty then.
void discard_run_folder(const std::filesystem::path& folder);

/// Writes plan.jsonl: one line a cell, its id and everything that is measured.
void write_plan(const std::filesystem::path& folder, const std::vector<Experiment>& cells);
/// The plan for `raymeter plan`.
[[nodiscard]] std::string plan_json(const std::vector<Experiment>& cells);

}  // namespace raymeter
