// SceneRun: verifying and counting.

#include <algorithm>

#include <fmt/format.h>

#include "core/base/threads.h"
#include "experiments/config/hash.h"
#include "experiments/record/tables.h"
#include "experiments/run/scene_run.h"
#include "experiments/run/verification.h"

namespace raymeter {

namespace {

AccuracyRecord to_record(const Accuracy& accuracy, const Answers& answers) {
  AccuracyRecord record{accuracy.rays_checked, accuracy.false_miss, accuracy.false_hit, accuracy.wrong_prim, {}, {}, {}};
  const bool distances =
      answers.query == Query::closest && std::any_of(answers.hits.prim.begin(), answers.hits.prim.end(), [](std::int32_t p) { return p >= 0; });
  if (distances) {
    record.t_ulp_p50 = accuracy.t_ulp_p50;
    record.t_ulp_p99 = accuracy.t_ulp_p99;
    record.t_ulp_max = accuracy.t_ulp_max;
  }
  return record;
}

}  // namespace

/// In groups that share a reference: those of one ray set on one instruction set.
void SceneRun::check_all() {
  std::vector<Live*> waiting;
  for (Live& live : live_) {
    if (!context_.log.records().checks.contains(live.cell->id)) waiting.push_back(&live);
  }
  while (!waiting.empty() && !context_.stop.requested()) {
    const Live& first = *waiting.front();
    const auto rest =
        std::stable_partition(waiting.begin(), waiting.end(), [&](const Live* live) { return live->rays == first.rays && live->cell->isa == first.cell->isa; });
    check_group({waiting.begin(), rest});
    waiting.erase(waiting.begin(), rest);
  }
}

void SceneRun::check_group(std::span<Live* const> group) {
  // A pass that would take too long is not begun.
  std::vector<Live*> affordable;
  for (Live* live : group) {
    const int threads = live->cell->threads > 0 ? live->cell->threads : all_threads();
    double pass_s = estimate_pass_s(*live->intersector, *live->rays) / threads;
    if (pass_s > context_.config.measure.timeout_s) pass_s = std::min(pass_s, estimate_pass_s(*live->intersector, *live->rays) / threads);
    if (pass_s <= context_.config.measure.timeout_s)
      affordable.push_back(live);
    else
      end(*live->cell, Status::timeout, fmt::format("one pass would take about {:.3g} s, timeout_s is {:.6g}", pass_s, context_.config.measure.timeout_s));
  }
  if (affordable.empty() || context_.stop.requested()) return;
  const Experiment& first = *affordable.front()->cell;
  tell(fmt::format("verifying {} rays on {}", first.rays.name, name(first.isa)));
  const std::unique_ptr<Intersector> reference = reference_for(first, affordable.front()->rays->rays.size());
  const Verification verification(oracle_.get(), *affordable.front()->rays, *reference, context_.config.verify, first.seed);
  for (Live* live : affordable) {
    if (context_.stop.requested()) return;
    check(*live, verification);
  }
}

/// `list`, where that is affordable; else the first structure of the scene's cells that is another.
std::unique_ptr<Intersector> SceneRun::reference_for(const Experiment& cell, std::size_t rays) {
  constexpr int kPacket = 16;
  if (static_cast<double>(rays) * scene_->prim_count() > context_.config.verify.max_tests) {
    for (const Live& live : live_) {
      const Experiment& other = *live.cell;
      if (other.structure->name != "list") return structures_.at(build_text(other))->intersector({cell.isa, kPacket, other.params});
    }
  }
  return list_->intersector({cell.isa, kPacket, {}});
}

void SceneRun::check(Live& live, const Verification& verification) {
  const Experiment& cell = *live.cell;
  tell("checking " + technique_text(cell));
  CheckRecord record;
  record.cell = cell.id;
  record.rays = static_cast<std::int64_t>(live.rays->rays.size());
  record.threads = cell.threads > 0 ? cell.threads : all_threads();
  record.counters.emplace();
  const PassTime time = run_pass(live.tracers(), *live.rays, cell.threads, answers_, &*record.counters);
  live.spent_s += time.trace_ms * 1e-3;
  const Verdicts verdicts = verification.judge(answers_);
  record.hit_hash = hex_text(answers_.hash());
  record.hit_mismatch = verdicts.mismatches;
  if (verdicts.accuracy) record.accuracy = to_record(*verdicts.accuracy, answers_);
  if (!verdicts.right) {
    record.status = Status::wrong;
    record.reason = fmt::format("{} of {} rays have wrong hits", verdicts.mismatches, live.rays->rays.size());
  }
  context_.log.add(record);
  context_.progress.add(verdicts.right ? passes_of(context_.config) - context_.config.measure.warmup - context_.config.measure.samples
                                       : passes_of(context_.config));
}

}  // namespace raymeter
