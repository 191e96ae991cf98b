#include "experiments/record/build_json.h"

namespace raymeter {

nlohmann::ordered_json to_json(const BuildStats& stats) {
  nlohmann::ordered_json json{{"nodes", stats.nodes()},
                              {"interior_nodes", stats.interior_nodes},
                              {"leaves", stats.leaves},
                              {"empty_leaves", stats.empty_leaves},
                              {"references", stats.references},
                              {"max_depth", nullptr},
                              {"sah_cost", nullptr},
                              {"epo", nullptr},
                              {"mem_bytes", stats.mem_bytes}};
  if (stats.max_depth) json["max_depth"] = *stats.max_depth;
  if (stats.sah_cost) json["sah_cost"] = *stats.sah_cost;
  if (stats.epo) json["epo"] = *stats.epo;
  return json;
}

BuildStats build_stats_from_json(const nlohmann::json& json) {
  BuildStats stats;
  stats.interior_nodes = json.at("interior_nodes");
  stats.leaves = json.at("leaves");
  stats.empty_leaves = json.at("empty_leaves");
  stats.references = json.at("references");
  if (!json.at("max_depth").is_null()) stats.max_depth = json.at("max_depth").get<std::int64_t>();
  if (!json.at("sah_cost").is_null()) stats.sah_cost = json.at("sah_cost").get<double>();
  if (!json.at("epo").is_null()) stats.epo = json.at("epo").get<double>();
  stats.mem_bytes = json.at("mem_bytes");
  return stats;
}

}  // namespace raymeter
