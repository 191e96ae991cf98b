// Rows of samples.csv, counters.csv, accuracy.csv and frames.csv.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "experiments/record/counter_columns.h"
#include "experiments/record/table_source.h"

namespace raymeter {

void add_sample_rows(const Source& source, const Experiment& cell, const RowPhase& phase, const AddRow& add) {
  const auto samples = source.records.samples.find(cell.id);
  if (samples == source.records.samples.end()) return;
  for (const auto& [index, sample] : samples->second) {
    const PhaseSample part = part_of(sample, phase.part);
    const auto rays = static_cast<double>(part.rays);
    const bool timed = sample.ok && part.rays > 0 && part.ms > 0;
    add({number(std::int64_t{index}), number(sample.order_index), sample.ok ? number(part.ms) : "", number(part.rays),
         timed ? number(rays / (part.ms * 1e3)) : "", timed ? number(part.ms * 1e6 / rays) : "", sample.ok ? "ok" : "wrong",
         sample.ok && !sample.phases ? number(sample.prepare_ms) : ""});
  }
}

namespace {

/// Shares of the rays of a phase, and of those that are blocked, that a cached blocker answers; empty where there is no cache.
Row cache_hit_rates(const Counters& counters, const std::optional<std::int64_t>& blocked) {
  if (counters.live(Event::cache_test) == 0) return Row(2);
  const auto hits = static_cast<double>(counters.live(Event::cache_hit));
  return {number(hits / static_cast<double>(counters.ray_count)), blocked && *blocked > 0 ? number(hits / static_cast<double>(*blocked)) : ""};
}

}  // namespace

void add_counter_rows(const Source& source, const Experiment& cell, const RowPhase& phase, const AddRow& add) {
  const Counters* const counters = source.counters(cell, phase);
  if (counters == nullptr) return;
  Row row{std::to_string(counters->ray_count)};
  for (const std::uint64_t sum : counters->rays) row.push_back(std::to_string(sum));
  for (const std::uint64_t sum : counters->packets) row.push_back(std::to_string(sum));
  for (std::string& average : counter_averages(cell, counters)) row.push_back(std::move(average));
  const std::optional<std::int64_t> hits = source.hits(cell, phase);
  row.push_back(number(hits));
  // A whole frame's rays are not all shadow rays: what the cache answers is in the row of these.
  const bool all_may_be_blocked = !cell.rays.image() || phase.part == FramePhase::shadow;
  for (std::string& rate : all_may_be_blocked ? cache_hit_rates(*counters, hits) : Row(2)) row.push_back(std::move(rate));
  const std::size_t width = row.size() + 5;
  if (const CheckRecord* const check = source.check(cell); check != nullptr && check->demand) {
    const DemandStats& made = check->demand->stats;
    const double per_cell = made.cells > 0 ? static_cast<double>(made.candidates) / static_cast<double>(made.cells) : 0;
    row.insert(row.end(), {number(check->demand->first_prepare_ms), number(made.cells), number(per_cell), number(static_cast<std::int64_t>(made.bytes)),
                           number(made.full_bytes)});
  }
  row.resize(width);
  add(std::move(row));
}

void add_accuracy_rows(const Source& source, const Experiment& cell, const RowPhase&, const AddRow& add) {
  const CheckRecord* const check = source.check(cell);
  if (check == nullptr || !(check->accuracy || check->frame || check->cells)) return;
  Row row(8);
  if (check->accuracy) {
    const AccuracyRecord& a = *check->accuracy;
    row = {number(a.rays_checked), number(a.false_miss), number(a.false_hit), number(a.wrong_prim),
           number(a.self_hits),    number(a.t_ulp_p50),  number(a.t_ulp_p99), number(a.t_ulp_max)};
  }
  if (check->frame) {
    const ImageError& error = check->frame->error;
    row.insert(row.end(), {number(error.rmse), number(error.psnr()), number(error.ssim)});
  }
  row.resize(11);
  if (check->cells) {
    const CellRecord& cells = *check->cells;
    row.insert(row.end(),
               {number(cells.rays_checked), number(cells.rays_missing), number(cells.rays_at_risk), number(cells.cells_missed), number(cells.longest)});
  }
  row.resize(16);
  add(std::move(row));
}

void add_frame_rows(const Source& source, const Experiment& cell, const RowPhase&, const AddRow& add) {
  const CheckRecord* const check = source.check(cell);
  if (check == nullptr || !check->frame) return;
  const FrameRecord& frame = *check->frame;
  const RayCounts& rays = frame.rays;
  Row row;
  for (const std::int64_t count : {rays.all(), rays.primary, rays.primary_hit, rays.reflection, rays.reflection_hit, rays.refraction, rays.refraction_hit,
                                   rays.tir, rays.shadow, rays.shadow_blocked, frame.rays_full - rays.all()}) {
    row.push_back(number(count));
  }
  row.push_back(number(frame.depth.mean()));
  row.push_back(std::to_string(frame.depth.generation.size()));
  row.push_back(fmt::format("{}", fmt::join(frame.depth.generation, " ")));
  for (const double value : {frame.bound.error_mean, frame.bound.error_max, frame.bound.bound_mean, frame.bound.bound_max}) row.push_back(number(value));
  row.push_back(number(frame.bound.exceeded));
  add(std::move(row));
}

}  // namespace raymeter
