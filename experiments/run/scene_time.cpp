// SceneRun: the timed passes, and builds for time alone.

#include <algorithm>
#include <chrono>
#include <new>
#include <numeric>

#include <fmt/format.h>

#include "experiments/config/hash.h"
#include "experiments/record/tables.h"
#include "experiments/run/scene_run.h"

namespace raymeter {

namespace {

std::uint64_t split_mix(std::uint64_t& state) noexcept {
  std::uint64_t z = state += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

/// 0 .. count-1 in an order that depends on the seed and the round alone.
std::vector<std::size_t> shuffled(std::size_t count, std::uint64_t seed, int round) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::uint64_t state = seed * 0x100000001b3u + static_cast<std::uint64_t>(round);
  for (std::size_t i = count; i > 1; --i) std::swap(order[i - 1], order[split_mix(state) % i]);
  return order;
}

}  // namespace

/// build_all made the first of each, which is kept.
void SceneRun::time_builds() {
  std::vector<const Experiment*> builds;
  for (const Experiment& cell : cells_) {
    const auto same = [&](const Experiment* build) { return build->threads == cell.threads && build_text(*build) == build_text(cell); };
    if (unfinished(cell) && std::none_of(builds.begin(), builds.end(), same)) builds.push_back(&cell);
  }
  for (int round = 1; round < context_.config.measure.builds; ++round) {
    tell(fmt::format("building, round {} of {}", round + 1, context_.config.measure.builds));
    for (const std::size_t i : shuffled(builds.size(), context_.config.seed, round)) {
      if (context_.stop.requested()) return;
      time_build(*builds[i], round);
    }
  }
}

void SceneRun::time_build(const Experiment& cell, int round) try {
  const BuildRecord& known = context_.log.records().builds.at({cell.scene.name, build_text(cell), cell.threads});
  if (known.build_ms.size() > static_cast<std::size_t>(round)) return;  // of a run that goes on
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const std::unique_ptr<Structure> structure = cell.structure->build(*scene_, cell.params, cell.threads);
  const double build_ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  context_.log.add(BuildRecord{known.scene, known.build, known.threads, {build_ms}, known.stats});
} catch (const std::bad_alloc&) {
  end(cell, Status::failed, "out of memory while building again");
}

void SceneRun::time_all() {
  std::erase_if(live_, [&](const Live& live) { return !unfinished(*live.cell); });
  if (live_.empty()) return;
  for (int round = 0; round < context_.config.measure.warmup; ++round) time_round(round, true);
  for (int round = 0; round < context_.config.measure.samples; ++round) time_round(round, false);
  context_.log.sync();
}

void SceneRun::time_round(int round, bool warmup) {
  tell(warmup ? std::string("warming up") : fmt::format("round {} of {}", round + 1, context_.config.measure.samples));
  for (const std::size_t i : shuffled(live_.size(), context_.config.seed, round)) {
    if (context_.stop.requested()) return;
    Live& live = live_[i];
    const auto& samples = context_.log.records().samples;
    const auto taken = samples.find(live.cell->id);
    const bool has_it = !warmup && taken != samples.end() && taken->second.contains(round);
    if (!has_it && unfinished(*live.cell)) time_pass(live, round, warmup);
  }
}

/// One pass by the timed kernels; its answers are to be checked still.
SampleRecord SceneRun::timed(Live& live) {
  const Experiment& cell = *live.cell;
  SampleRecord record;
  record.cell = cell.id;
  PassTime time;
  if (live.rays != nullptr) {
    time = run_pass(live.tracers(), *live.rays, cell.threads, answers_);
    record.rays = static_cast<std::int64_t>(live.rays->rays.size());
  } else {
    const FramePass pass = run_frame(live.tracers(), live.frame, cell.threads, answers_);
    time = pass.time;
    record.rays = pass.rays.all();
    record.phases.emplace();
    for (std::size_t phase = 0; phase < kFramePhases.size(); ++phase) (*record.phases)[phase] = {pass.totals.phase[phase].ms, pass.totals.phase[phase].rays};
  }
  record.prepare_ms = time.prepare_ms;
  record.trace_ms = time.trace_ms;
  record.cpu_ms = time.cpu_ms;
  return record;
}

void SceneRun::time_pass(Live& live, int round, bool warmup) {
  const Experiment& cell = *live.cell;
  const MeasureOptions& measure = context_.config.measure;
  RunLog& log = context_.log;
  if (live.spent_s + live.pass_s > measure.timeout_s) {
    const int taken = log.records().samples_of(cell.id);
    log.add(EndRecord{cell.id, Status::timeout, fmt::format("{} of {} samples in timeout_s = {:.6g}", taken, measure.samples, measure.timeout_s)});
    context_.progress.add(measure.samples - taken);
    return;
  }
  context_.pinning.enter(cell.threads);
  SampleRecord record = timed(live);
  context_.pinning.leave();
  live.pass_s = record.trace_ms * 1e-3;
  live.spent_s += live.pass_s;
  context_.progress.add(1);
  // Timed and counting kernels are different code: they have to agree.
  record.sample = round;
  record.order_index = log.records().sample_count;
  record.ok = hex_text(answers_.hash()) == log.records().checks.at(cell.id).hit_hash;
  if (!warmup) log.add(record);
  if (!record.ok) log.add(EndRecord{cell.id, Status::wrong, "a timed pass gave other hits than the counted one"});
}

}  // namespace raymeter
