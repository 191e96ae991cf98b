#include "experiments/record/build_json.h"

#include <array>
#include <utility>

namespace raymeter {

namespace {

using Quality = std::optional<double> BuildStats::*;
constexpr std::array<std::pair<const char*, Quality>, 10> kQualities{{{"sah_cost", &BuildStats::sah_cost},
                                                                      {"epo", &BuildStats::epo},
                                                                      {"sibling_distance", &BuildStats::sibling_distance},
                                                                      {"node_volume", &BuildStats::node_volume},
                                                                      {"total_volume", &BuildStats::total_volume},
                                                                      {"cost_depth", &BuildStats::cost_depth},
                                                                      {"cost_depth_p90", &BuildStats::cost_depth_p90},
                                                                      {"epo_se", &BuildStats::epo_se},
                                                                      {"volume_area", &BuildStats::volume_area},
                                                                      {"void_area", &BuildStats::void_area}}};

}  // namespace

nlohmann::ordered_json to_json(const BuildStats& stats) {
  nlohmann::ordered_json json{{"nodes", stats.nodes()},         {"interior_nodes", stats.interior_nodes},
                              {"leaves", stats.leaves},         {"empty_leaves", stats.empty_leaves},
                              {"references", stats.references}, {"max_depth", nullptr},
                              {"mem_bytes", stats.mem_bytes}};
  if (stats.max_depth) json["max_depth"] = *stats.max_depth;
  for (const auto& [key, quality] : kQualities) {
    json[key] = nullptr;
    if (stats.*quality) json[key] = *(stats.*quality);
  }
  return json;
}

BuildStats build_stats_from_json(const nlohmann::json& json) {
  BuildStats stats;
  stats.interior_nodes = json.at("interior_nodes");
  stats.leaves = json.at("leaves");
  stats.empty_leaves = json.at("empty_leaves");
  stats.references = json.at("references");
  if (!json.at("max_depth").is_null()) stats.max_depth = json.at("max_depth").get<std::int64_t>();
  for (const auto& [key, quality] : kQualities) {
    if (json.contains(key) && !json.at(key).is_null()) stats.*quality = json.at(key).get<double>();
  }
  stats.mem_bytes = json.at("mem_bytes");
  return stats;
}

}  // namespace raymeter
