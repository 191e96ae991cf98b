#include "experiments/record/table_source.h"

#include <fmt/format.h>

#include "experiments/record/counter_columns.h"
#include "experiments/record/tables.h"

namespace raymeter {

const CheckRecord* Source::check(const Experiment& cell) const {
  const auto found = records.checks.find(cell.id);
  return found == records.checks.end() ? nullptr : &found->second;
}

const SceneRecord* Source::scene(const Experiment& cell) const {
  const auto found = records.scenes.find(cell.scene.name);
  return found == records.scenes.end() ? nullptr : &found->second;
}

const BuildRecord* Source::build(const Experiment& cell) const {
  const auto found = records.builds.find({cell.scene.name, build_text(cell), cell.threads});
  return found == records.builds.end() ? nullptr : &found->second;
}

std::vector<RowPhase> Source::phases(const Experiment& cell) const {
  if (!cell.rays.image()) {
    const bool any = cell.rays.any || cell.rays.kind() == "shadow" || cell.rays.kind() == "ambient_occlusion";
    return {{any ? "any" : "closest", {}}};
  }
  std::vector<RowPhase> phases{{"total", {}}};
  const CheckRecord* const record = check(cell);
  if (record == nullptr || !record->frame) return phases;
  for (const FramePhase phase : kFramePhases) {
    const bool shading = phase == FramePhase::shading;
    if (shading || record->frame->counters[static_cast<std::size_t>(phase)].ray_count > 0) phases.push_back({name(phase), phase});
  }
  return phases;
}

const Counters* Source::counters(const Experiment& cell, const RowPhase& phase) const {
  const CheckRecord* const record = check(cell);
  if (record == nullptr || phase.part == FramePhase::shading) return nullptr;
  if (phase.part) return &record->frame->counters[static_cast<std::size_t>(*phase.part)];
  return record->counters ? &*record->counters : nullptr;
}

std::optional<std::int64_t> Source::hits(const Experiment& cell, const RowPhase& phase) const {
  const CheckRecord* const record = check(cell);
  if (record == nullptr || !record->frame) return record != nullptr ? record->hits : std::nullopt;
  const RayCounts& rays = record->frame->rays;
  if (!phase.part) return rays.primary_hit + rays.shadow_blocked + rays.reflection_hit + rays.refraction_hit;
  switch (*phase.part) {
    case FramePhase::first_hit: return rays.primary_hit;
    case FramePhase::shadow: return rays.shadow_blocked;
    case FramePhase::reflection: return rays.reflection_hit;
    case FramePhase::refraction: return rays.refraction_hit;
    case FramePhase::shading: return std::nullopt;
  }
  return std::nullopt;
}

PhaseSample part_of(const SampleRecord& sample, const std::optional<FramePhase>& part) noexcept {
  if (!part || !sample.phases) return {sample.trace_ms, sample.rays};
  PhaseSample one = (*sample.phases)[static_cast<std::size_t>(*part)];
  if (part == FramePhase::shading) one.rays = sample.rays;
  return one;
}

std::string number(double value) { return fmt::format("{:.9g}", value); }
std::string number(std::int64_t value) { return std::to_string(value); }

Row counter_averages(const Experiment& cell, const Counters* counters) {
  if (counters == nullptr || counters->ray_count == 0) return Row(3);
  const auto rays = static_cast<double>(counters->ray_count);
  return {number(static_cast<double>(counters->live(Event::node_visit)) / rays), number(static_cast<double>(counters->live(Event::prim_test)) / rays),
          number(simd_utilization(*counters, simd_width(cell.isa)))};
}

}  // namespace raymeter
