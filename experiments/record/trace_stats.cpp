#include "experiments/record/trace_stats.h"

#include "experiments/record/build_json.h"
#include "experiments/record/counter_columns.h"
#include "experiments/record/param_json.h"

namespace raymeter {

std::string trace_stats_json(const TraceStats& stats) {
  const nlohmann::ordered_json json{
      {"scene", stats.scene},
      {"num_prims", stats.num_prims},
      {"structure", stats.technique.structure->name},
      {"params", to_json(stats.technique.params)},
      {"choice", stats.choice},
      {"query", stats.query},
      {"isa", name(stats.isa)},
      {"packet", stats.packet},
      {"threads", stats.threads},
      {"rays", stats.rays},
      {"hits", stats.hits},
      {"build_ms", stats.build_ms},
      {"trace_ms", stats.trace_ms},
      {"build", to_json(stats.build)},
      {"counters", to_json(stats.counters)},
  };
  return json.dump(2) + "\n";
}

}  // namespace raymeter
