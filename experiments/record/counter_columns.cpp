#include "experiments/record/counter_columns.h"

#include <string>

namespace raymeter {

nlohmann::ordered_json to_json(const Counters& counters) {
  nlohmann::ordered_json json{{"ray_count", counters.ray_count}};
  for (std::size_t e = 0; e < kEventCount; ++e) json[std::string(kCounterColumns[e])] = counters.rays[e];
  for (std::size_t e = 0; e < kEventCount; ++e) json[std::string(kCounterColumns[e]) + "_packets"] = counters.packets[e];
  return json;
}

Counters counters_from_json(const nlohmann::json& json) {
  Counters counters;
  counters.ray_count = json.at("ray_count");
  for (std::size_t e = 0; e < kEventCount; ++e) {
    counters.rays[e] = json.at(std::string(kCounterColumns[e]));
    counters.packets[e] = json.at(std::string(kCounterColumns[e]) + "_packets");
  }
  return counters;
}

std::optional<double> simd_utilization(const Counters& counters, int simd_width) noexcept {
  std::uint64_t live = 0;
  std::uint64_t executed = 0;
  for (const Event event : {Event::node_visit, Event::volume_test, Event::prim_test}) {
    live += counters.live(event);
    executed += counters.executed(event);
  }
  if (executed == 0) return std::nullopt;
  return static_cast<double>(live) / (static_cast<double>(executed) * simd_width);
}

}  // namespace raymeter
