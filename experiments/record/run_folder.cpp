#include "experiments/record/run_folder.h"

#include <cerrno>
#include <cstring>
#include <fstream>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "experiments/atomic_file.h"
#include "experiments/config/expand.h"
#include "experiments/config/hash.h"
#include "experiments/record/environment.h"

namespace raymeter {

namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

const fs::path kResults = "results";
constexpr const char* kRunFiles[]{"manifest.json", "environment.json", "samples.jsonl", "plan.jsonl", "summary.csv",    "samples.csv",
                                  "builds.csv",    "counters.csv",     "accuracy.csv",  "frames.csv", "break_even.csv", "benchmark.json"};

Json plan_line(const Experiment& cell) {
  Json json{{"cell", cell.id}};
  json.update(Json::parse(canonical_json(cell)));
  if (!cell.scene.absent.empty()) json["scene_absent"] = true;
  if (cell.scene.absent.empty() && cell.scene.spec != cell.scene.name) json["scene_file"] = cell.scene.spec;
  return json;
}

void write_whole(const fs::path& path, std::string_view text) {
  AtomicFile file(path.string());
  file.write(text);
  file.commit();
}

}  // namespace

std::string plan_hash(const Config& config, const std::vector<Experiment>& cells) {
  const MeasureOptions& m = config.measure;
  const VerifyOptions& v = config.verify;
  std::string text = fmt::format("{} {} {} {} {} {} {}", config.name, m.warmup, m.samples, m.builds, v.oracle, v.max_tests, v.hit_mismatch_max);
  for (const Experiment& cell : cells) text += " " + cell.id;
  return hash_text(text);
}

std::optional<Manifest> read_manifest(const fs::path& folder) {
  std::ifstream file(folder / "manifest.json");
  if (!file) return std::nullopt;
  try {
    const nlohmann::json json = nlohmann::json::parse(file);
    return Manifest{json.at("name"),    json.at("plan"),      json.at("state"),     json.at("config"), json.at("config_text").dump(),
                    json.at("command"), json.at("begun_utc"), json.at("ended_utc"), json.at("host"),   json.at("cpu"),
                    json.at("git_sha"), json.at("git_dirty"), json.at("cells")};
  } catch (const nlohmann::json::exception&) {
    throw Error((folder / "manifest.json").string() + ": not a manifest of a run");
  }
}

void write_manifest(const fs::path& folder, const Manifest& m) {
  const Json json{{"schema_version", kSchemaVersion},
                  {"name", m.name},
                  {"plan", m.plan},
                  {"state", m.state},
                  {"config", m.config},
                  {"config_text", Json::parse(m.config_text)},
                  {"command", m.command},
                  {"begun_utc", m.begun_utc},
                  {"ended_utc", m.ended_utc},
                  {"host", m.host},
                  {"cpu", m.cpu},
                  {"git_sha", m.git_sha},
                  {"git_dirty", m.git_dirty},
                  {"cells", m.cells}};
  write_whole(folder / "manifest.json", json.dump(2) + "\n");
}

std::string why_not_continued(const Manifest& manifest) {
  const Fingerprint here = fingerprint();
  if (manifest.cpu != here.cpu || manifest.host != here.host) return "was begun on another machine: " + manifest.host + ", " + manifest.cpu;
  if (manifest.git_sha != here.git_sha || manifest.git_dirty != here.git_dirty) return "was begun by another build, of commit " + manifest.git_sha;
  return {};
}

std::optional<fs::path> newest_run(const std::string& name, const std::string& plan) {
  std::optional<fs::path> newest;
  bool newest_complete = true;
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(kResults / name, none)) {
    const std::optional<Manifest> manifest = read_manifest(entry.path());
    if (!manifest || manifest->plan != plan || !why_not_continued(*manifest).empty()) continue;
    const bool complete = manifest->state == "complete";
    const bool newer = !newest || entry.path().filename() > newest->filename();  // names begin with the time
    if (complete == newest_complete ? !newer : complete) continue;
    newest = entry.path();
    newest_complete = complete;
  }
  return newest;
}

fs::path new_run_path(const std::string& name) {
  const Fingerprint here = fingerprint();
  const fs::path path = kResults / name / fmt::format("{}_{}_{}", utc_stamp(), here.git_sha, here.host);
  fs::path unused = path;
  for (int n = 2; fs::exists(unused); ++n) unused = fmt::format("{}-{}", path.string(), n);  // several runs in one second
  return unused;
}

RunFolder::RunFolder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) throw Error(fmt::format("{}: cannot be made: {}", path.string(), error.message()));
  if (::access(path.c_str(), W_OK | X_OK) != 0) throw Error(fmt::format("{}: cannot be written: {}", path.string(), std::strerror(errno)));
  descriptor_ = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor_ >= 0 && ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
  if (descriptor_ >= 0) ::close(descriptor_);
  throw Error(path.string() + ": another process is running this experiment");
}

RunFolder::~RunFolder() { ::close(descriptor_); }

void clear_run_folder(const fs::path& folder) {
  for (const char* name : kRunFiles) fs::remove(folder / name);
}

void discard_run_folder(const fs::path& folder) {
  clear_run_folder(folder);
  std::error_code not_empty;
  if (fs::remove(folder, not_empty)) fs::remove(folder.parent_path(), not_empty);
}

void write_plan(const fs::path& folder, const std::vector<Experiment>& cells) {
  std::string text;
  for (const Experiment& cell : cells) text += plan_line(cell).dump() + "\n";
  write_whole(folder / "plan.jsonl", text);
}

std::string plan_json(const std::vector<Experiment>& cells) {
  Json json = Json::array();
  for (const Experiment& cell : cells) json.push_back(plan_line(cell));
  return json.dump(2) + "\n";
}

}  // namespace raymeter
