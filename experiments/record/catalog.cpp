#include "experiments/record/catalog.h"

#include <nlohmann/json.hpp>

#include "accel/registry.h"
#include "core/simd/isa.h"
#include "experiments/cases/hard_case.h"
#include "experiments/record/metrics.h"
#include "experiments/record/param_json.h"
#include "experiments/scenes/generators.h"

namespace raymeter {

namespace {

using Json = nlohmann::ordered_json;

std::string_view type_name(const ParamValue& value) noexcept {
  constexpr std::string_view names[]{"boolean", "integer", "number", "string"};
  return names[value.index()];
}

Json param_object(const ParamInfo& info) {
  Json json{{"key", info.key}, {"type", type_name(info.default_value)}, {"default", to_json(info.default_value)}};
  if (std::holds_alternative<std::int64_t>(info.default_value)) {
    json["min"] = static_cast<std::int64_t>(info.min);
    json["max"] = static_cast<std::int64_t>(info.max);
    if (!info.also.empty()) json["also"] = info.also;
  } else if (std::holds_alternative<double>(info.default_value)) {
    json["min"] = info.min;
    json["max"] = info.max;
  }
  if (!info.choices.empty()) json["choices"] = info.choices;
  json["use"] = info.use == ParamUse::build ? "build" : "query";
  if (!info.same_build.empty()) json["same_build"] = info.same_build;
  json["help"] = info.help;
  return json;
}

Json technique_object(const TechniqueInfo& technique) {
  Json params = Json::array();
  for (const ParamInfo& info : technique.params()) params.push_back(param_object(info));
  return {{"name", technique.name}, {"slot", technique.slot}, {"summary", technique.summary}, {"source", technique.source}, {"params", params}};
}

}  // namespace

std::string technique_json(const TechniqueInfo& technique) { return technique_object(technique).dump(2); }

std::string techniques_json() {
  Json json = Json::array();
  for (const TechniqueInfo& technique : techniques()) json.push_back(technique_object(technique));
  return json.dump(2);
}

std::string scenes_json() {
  Json json = Json::array();
  for (const SceneGenerator& generator : scene_generators()) {
    json.push_back({{"name", generator.spec_prefix},
                    {"summary", generator.summary},
                    {"size_means", generator.size_means},
                    {"default_size", generator.default_size},
                    {"min_size", generator.min_size},
                    {"max_size", generator.max_size}});
  }
  for (const HardCase& row : hard_cases()) json.push_back({{"name", "hard:" + std::string(row.name)}, {"summary", row.summary}});
  return json.dump(2);
}

std::string isas_json() {
  Json json = Json::array();
  for (const Isa isa : kIsas) json.push_back({{"name", name(isa)}, {"simd_width", simd_width(isa)}, {"available", available(isa)}});
  return json.dump(2);
}

std::string metrics_json() {
  Json json = Json::array();
  for (const Metric& metric : metrics()) {
    json.push_back({{"name", metric.name}, {"table", name(metric.table)}, {"better", name(metric.better)}, {"help", metric.help}});
  }
  return json.dump(2);
}

}  // namespace raymeter
