#include "experiments/run/runner.h"

#include <fmt/format.h>

#include "core/base/error.h"
#include "experiments/atomic_file.h"
#include "experiments/record/environment.h"
#include "experiments/record/run_folder.h"
#include "experiments/record/tables.h"
#include "experiments/run/scene_run.h"

namespace raymeter {

namespace fs = std::filesystem;

namespace {

/// Where the run goes, and the manifest of the run that it continues.
struct Place {
  fs::path folder;
  std::optional<Manifest> continued;
};

void check_can_continue(const fs::path& folder, const Manifest& manifest, const std::string& plan) {
  const auto refuse = [&](const std::string& why) { throw Error(fmt::format("{}: {}; --fresh starts anew", folder.string(), why)); };
  if (manifest.plan != plan) refuse("holds a run of another config");
  if (const std::string why = why_not_continued(manifest); !why.empty()) refuse(why);
}

Place choose_place(const Config& config, const RunOptions& options, const std::string& plan, RunResult& result) {
  if (!options.out.empty()) {
    const fs::path folder = options.out;
    const std::optional<Manifest> there = read_manifest(folder);
    if (!there || options.fresh) return {folder, std::nullopt};
    if (!options.resume) throw Error(folder.string() + ": holds a run already; --resume continues it, --fresh starts anew");
    return {folder, there};
  }
  const std::optional<fs::path> newest = newest_run(config.name, plan);
  if (newest && options.resume) return {*newest, read_manifest(*newest)};
  if (newest && !options.fresh && read_manifest(*newest)->state != "complete") result.unfinished_run = newest;
  return {new_run_path(config.name), std::nullopt};
}

Manifest new_manifest(const Config& config, const std::vector<Experiment>& cells, const RunOptions& options, const std::string& plan) {
  const Fingerprint here = fingerprint();
  return {config.name, plan,      "running", config.path,  config.text,    options.command, utc_stamp(),
          "",          here.host, here.cpu,  here.git_sha, here.git_dirty, cells.size()};
}

void begin_folder(const fs::path& folder, const std::vector<Experiment>& cells, const Manifest& manifest) {
  clear_run_folder(folder);
  write_plan(folder, cells);
  AtomicFile environment((folder / "environment.json").string());
  environment.write(environment_json());
  environment.commit();
  write_manifest(folder, manifest);  // last: a folder with a manifest is a run
}

void run_scenes(RunContext& context) {
  const std::vector<Experiment>& cells = context.cells;
  for (std::size_t first = 0; first < cells.size() && !context.stop.requested();) {
    std::size_t end = first + 1;
    while (end < cells.size() && cells[end].scene.name == cells[first].scene.name) ++end;
    SceneRun(context, std::span(cells).subspan(first, end - first)).run();
    first = end;
  }
}

std::int64_t passes_done(const RunContext& context) {
  std::int64_t done = 0;
  for (const Experiment& cell : context.cells) {
    const bool finished = context.status(cell) != Status::unfinished;
    done += finished ? passes_of(context.config) : context.log.records().samples_of(cell.id);
  }
  return done;
}

void sum_up(const Config& config, const std::vector<Experiment>& cells, const RunRecords& records, RunResult& result) {
  for (const Experiment& cell : cells) {
    const Status status = records.status(cell.id, config.measure.samples);
    ++result.cells[status];
    if (status == Status::ok || status == Status::unfinished) continue;
    result.complaints.push_back(fmt::format("{}: {} {} {} packet {} {} threads {}: {}", name(status), cell.scene.name, technique_text(cell), name(cell.isa),
                                            cell.packet, cell.rays.name, threads_text(cell.threads), records.reason(cell.id)));
  }
}

/// Derives what a run ends with, whole or not.
void finish(const RunContext& context, const fs::path& folder, Manifest& manifest) {
  context.log.sync();
  write_tables(folder, context.config, context.cells, context.log.records());
  manifest.state = context.cells_done() == context.cells.size() ? "complete" : "interrupted";
  manifest.ended_utc = utc_stamp();
  write_manifest(folder, manifest);
}

}  // namespace

RunResult run_experiment(const Config& config, const std::vector<Experiment>& cells, const RunOptions& options, Progress& progress) {
  if (cells.empty()) throw Error(config.path + ": no cells to run: all are excluded or filtered out");
  RunResult result;
  Pinning pinning(options.pin);
  const std::string plan = plan_hash(config, cells);
  const Place place = choose_place(config, options, plan, result);
  result.folder = place.folder;
  Manifest manifest = place.continued.value_or(new_manifest(config, cells, options, plan));
  const RunFolder folder(place.folder);
  if (place.continued)
    check_can_continue(place.folder, manifest, plan);
  else
    begin_folder(place.folder, cells, manifest);

  const Stop stop(config.measure.max_time_s);
  RunLog log(place.folder / "samples.jsonl");
  RunContext context{config, cells, log, progress, pinning, stop};
  result.nothing_to_do = place.continued && context.cells_done() == cells.size();
  progress.begin(passes_of(config) * static_cast<std::int64_t>(cells.size()), passes_done(context));
  try {
    run_scenes(context);
  } catch (const Error&) {  // a scene's file is damaged: what came before it stays, and nothing stays of nothing
    progress.end();
    if (!place.continued && log.records().scenes.empty())
      discard_run_folder(place.folder);
    else
      finish(context, place.folder, manifest);
    throw;
  }
  progress.end();
  finish(context, place.folder, manifest);
  sum_up(config, cells, log.records(), result);
  if (result.cells[Status::unfinished] > 0) result.stopped = stop.reason();
  return result;
}

}  // namespace raymeter
