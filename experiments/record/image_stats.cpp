#include "experiments/record/image_stats.h"

#include "experiments/record/counter_columns.h"
#include "experiments/record/param_json.h"

namespace raymeter {

namespace {

using Json = nlohmann::ordered_json;

/// Time and counts of each phase; the time is that of the counting kernels.
Json phases_json(const FrameTotals& totals) {
  Json json = Json::object();
  for (const FramePhase phase : kFramePhases) {
    const PhaseTotals& one = totals[phase];
    json[std::string(name(phase))] = {{"ms", one.ms}, {"rays", one.rays}};
    if (one.rays > 0) json[std::string(name(phase))]["counters"] = to_json(one.counters);
  }
  return json;
}

}  // namespace

std::string image_stats_json(const ImageStats& stats) {
  const PhaseTotals all = stats.totals.sum();
  Json json{
      {"scene", stats.scene},
      {"num_prims", stats.num_prims},
      {"structure", stats.technique.structure->name},
      {"params", to_json(stats.technique.params)},
      {"choice", stats.choice},
      {"first_hit", technique_text(stats.technique.first_hit)},
      {"occlusion", technique_text(stats.technique.occlusion)},
      {"camera", name(stats.model.convention)},
      {"width", stats.model.width},
      {"height", stats.model.height},
      {"max_depth", stats.termination.max_depth},
      {"min_weight", stats.termination.min_weight},
      {"isa", name(stats.isa)},
      {"packet", stats.packet},
      {"threads", stats.threads},
      {"primary", stats.rays.primary},
      {"primary_hit", stats.rays.primary_hit},
      {"reflection", stats.rays.reflection},
      {"reflection_hit", stats.rays.reflection_hit},
      {"refraction", stats.rays.refraction},
      {"refraction_hit", stats.rays.refraction_hit},
      {"tir", stats.rays.tir},
      {"shadow", stats.rays.shadow},
      {"shadow_blocked", stats.rays.shadow_blocked},
      {"generations", stats.depth.generation},
      {"mean_depth", stats.depth.mean()},
      {"ms", all.ms},
      {"phases", phases_json(stats.totals)},
      {"counters", to_json(all.counters)},
  };
  if (stats.heatmap) json["heatmap"] = {{"event", stats.heatmap->event}, {"most", stats.heatmap->most}, {"mean", stats.heatmap->mean}};
  return json.dump(2) + "\n";
}

}  // namespace raymeter
