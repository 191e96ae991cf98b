#include "experiments/record/image_stats.h"

#include "experiments/record/counter_columns.h"
#include "experiments/record/param_json.h"

namespace raymeter {

std::string image_stats_json(const ImageStats& stats) {
  nlohmann::ordered_json json{
      {"scene", stats.scene},
      {"num_prims", stats.num_prims},
      {"structure", stats.technique.structure->name},
      {"params", to_json(stats.technique.params)},
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
      {"counters", to_json(stats.counters)},
  };
  if (stats.heatmap) json["heatmap"] = {{"event", stats.heatmap->event}, {"most", stats.heatmap->most}, {"mean", stats.heatmap->mean}};
  return json.dump(2) + "\n";
}

}  // namespace raymeter
