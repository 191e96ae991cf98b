// SceneRun: verifying and counting.

#include <algorithm>
#include <tuple>

#include <fmt/format.h>

#include "accel/weak_settings.h"
#include "core/base/threads.h"
#include "core/trace/cell_walk.h"
#include "experiments/config/hash.h"
#include "experiments/record/tables.h"
#include "experiments/run/scene_run.h"
#include "experiments/run/verification.h"
#include "experiments/verify/cell_truth.h"

namespace raymeter {

/// In groups that share a reference: those of one ray set on one instruction set, or of images of one depth.
void SceneRun::check_all() {
  std::vector<Live*> waiting;
  for (Live& live : live_) {
    if (!context_.log.records().checks.contains(live.cell->id)) waiting.push_back(&live);
  }
  const auto key = [](const Live& live) { return std::tuple(live.rays, live.cell->isa, live.cell->max_depth); };
  while (!waiting.empty() && !context_.stop.requested()) {
    const Live& first = *waiting.front();
    const auto rest = std::stable_partition(waiting.begin(), waiting.end(), [&](const Live* live) { return key(*live) == key(first); });
    const std::vector<Live*> group = affordable({waiting.begin(), rest});
    if (!group.empty() && !context_.stop.requested()) first.rays != nullptr ? check_ray_sets(group) : check_frames(group);
    waiting.erase(waiting.begin(), rest);
  }
}

double SceneRun::estimate_s(const Live& live) const {
  const int threads = live.cell->threads > 0 ? live.cell->threads : all_threads();
  return (live.rays != nullptr ? estimate_pass_s(*live.intersector, *live.rays) : estimate_frame_s(live.tracers(), live.frame)) / threads;
}

/// Those whose pass does not take too long; the others end before they begin.
std::vector<SceneRun::Live*> SceneRun::affordable(std::span<Live* const> group) {
  std::vector<Live*> affordable;
  const double timeout_s = context_.config.measure.timeout_s;
  for (Live* live : group) {
    double pass_s = estimate_s(*live);
    if (pass_s > timeout_s) pass_s = std::min(pass_s, estimate_s(*live));
    forget_made(*live);  // it would be missing from the first pass
    if (pass_s <= timeout_s)
      affordable.push_back(live);
    else
      end(*live->cell, Status::timeout, fmt::format("one pass would take about {:.3g} s, timeout_s is {:.6g}", pass_s, timeout_s));
  }
  return affordable;
}

void SceneRun::forget_made(Live& live) const {
  if (dynamic_cast<const OnDemand*>(live.intersector.get()) == nullptr) return;
  const double spent_s = live.spent_s;
  live = make_live(*live.cell, live.rays);
  live.spent_s = spent_s;
}

void SceneRun::check_ray_sets(std::span<Live* const> group) {
  const Experiment& first = *group.front()->cell;
  const RaySet& rays = *group.front()->rays;
  tell(fmt::format("verifying {} rays on {}", first.rays.name, name(first.isa)));
  const std::unique_ptr<Intersector> reference = reference_for(first, static_cast<double>(rays.rays.size()));
  const Verification verification(oracle_.get(), rays, *reference, context_.config.verify, first.seed, judgements_[&rays]);
  for (Live* live : group) {
    if (context_.stop.requested()) return;
    check_ray_set(*live, verification);
  }
}

/// `list`, where that is affordable; else the first structure of the scene's cells that is another, and answers as we do.
std::unique_ptr<Intersector> SceneRun::reference_for(const Experiment& cell, double rays) {
  constexpr int kPacket = 16;
  if (rays * scene_->prim_count() > context_.config.verify.max_tests) {
    for (const Live& live : live_) {
      const Experiment& other = *live.cell;
      if (other.structure->name != "list" && !answers_for_itself(*other.structure, other.params))
        return structures_.at(build_text(other))->intersector({cell.isa, kPacket, other.params});
    }
  }
  return list_->intersector({cell.isa, kPacket, {}});
}

void SceneRun::check_ray_set(Live& live, const Verification& verification) {
  const Experiment& cell = *live.cell;
  tell("checking " + technique_text(cell));
  CheckRecord record;
  record.cell = cell.id;
  record.rays = static_cast<std::int64_t>(live.rays->rays.size());
  record.threads = cell.threads > 0 ? cell.threads : all_threads();
  record.counters.emplace();
  const PassTime time = run_pass(live.tracers(), *live.rays, cell.threads, answers_, &*record.counters);
  live.spent_s += time.trace_ms * 1e-3;
  // Behind another slot the structure sees other batches than the cell's.
  const auto* const made = live.first_hit || live.occlusion ? nullptr : dynamic_cast<const OnDemand*>(live.intersector.get());
  if (made != nullptr) record.demand = {time.prepare_ms, made->demand()};
  record.choice = live.intersector->choice(answers_.kind == Answers::Kind::any ? Query::any : Query::closest);
  if (cell.structure->peer) record.counters.reset();
  const Verdicts verdicts = answers_for_itself(*cell.structure, cell.params) ? verification.list_errors(answers_) : verification.judge(answers_);
  record.hit_hash = hex_text(answers_.hash());
  record.hit_mismatch = verdicts.mismatches;
  record.hits = answers_.hit_count();
  const bool finds_distances = answers_.kind == Answers::Kind::closest && *record.hits > 0;
  if (verdicts.accuracy) record.accuracy = to_record(*verdicts.accuracy, finds_distances);
  const auto* const walk = context_.config.verify.cells ? dynamic_cast<const CellWalk*>(live.intersector.get()) : nullptr;
  if (walk != nullptr) {
    const CellAccuracy cells = verify_cells(*walk, live.rays->rays, {context_.config.verify.max_tests, cell.seed});
    record.cells = CellRecord{cells.rays_checked, cells.rays_missing, cells.rays_at_risk, cells.cells_missed, cells.longest};
  }
  if (!verdicts.right) {
    record.status = Status::wrong;
    record.reason = fmt::format("{} of {} rays have wrong hits", verdicts.mismatches, live.rays->rays.size());
  }
  add_check(record);
  if (record.status != Status::ok || context_.config.measure.samples == 0) forget_made(live);  // it would be kept as long as the scene
}

void SceneRun::add_check(const CheckRecord& record) {
  context_.log.add(record);
  const MeasureOptions& measure = context_.config.measure;
  context_.progress.add(passes_of(context_.config) - (record.status == Status::ok ? measure.warmup + measure.samples : 0));
}

}  // namespace raymeter
