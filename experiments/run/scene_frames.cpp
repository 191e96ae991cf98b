// SceneRun: verifying and counting images.

#include <fmt/format.h>

#include "accel/registry.h"
#include "core/base/threads.h"
#include "core/trace/trace.h"
#include "experiments/config/hash.h"
#include "experiments/record/tables.h"
#include "experiments/run/frame_verification.h"
#include "experiments/run/scene_run.h"
#include "experiments/run/verification.h"

namespace raymeter {

void SceneRun::check_frames(std::span<Live* const> group) {
  constexpr int kPacket = 16;
  constexpr double kRaysPerPixel = 4;  // about, for choosing a reference
  const Live& first = *group.front();
  const Experiment& cell = *first.cell;
  tell(fmt::format("verifying images on {}", name(cell.isa)));
  const bool list = kRaysPerPixel * first.frame.model.pixel_count() * scene_->prim_count() <= context_.config.verify.max_tests;
  const std::unique_ptr<Intersector> reference = list ? reference_for(cell, 0) : bvh_->intersector({cell.isa, kPacket, structure_entry("bvh").resolve({})});
  FrameVerification verification(oracle_.get(), first.frame, *reference, context_.config.verify, cell.seed);
  for (Live* live : group) {
    if (context_.stop.requested()) return;
    check_frame(*live, verification);
  }
}

void SceneRun::check_frame(Live& live, FrameVerification& verification) {
  const Experiment& cell = *live.cell;
  tell("checking " + technique_text(cell));
  const FramePass pass = run_frame(live.tracers(), live.frame, cell.threads, answers_, true);
  live.spent_s += pass.time.trace_ms * 1e-3;
  const FrameVerdict verdict = verification.judge(answers_, cell.min_weight, pass.bound);
  CheckRecord record;
  record.cell = cell.id;
  record.rays = pass.rays.all();
  record.threads = cell.threads > 0 ? cell.threads : all_threads();
  record.choice = choices(*live.intersector);
  record.counters = pass.totals.sum().counters;
  record.hit_hash = hex_text(answers_.hash());
  record.hit_mismatch = verdict.mismatches;
  if (const auto& accuracy = verification.accuracy()) record.accuracy = to_record(*accuracy, pass.rays.primary_hit > 0);
  record.frame = FrameRecord{pass.rays, pass.depth, {}, verdict.rays_full, verdict.error, verdict.bound};
  for (std::size_t phase = 0; phase < kFramePhases.size(); ++phase) record.frame->counters[phase] = pass.totals.phase[phase].counters;
  if (!verdict.complaint.empty()) {
    record.status = Status::wrong;
    record.reason = verdict.complaint;
  }
  add_check(record);
}

}  // namespace raymeter
