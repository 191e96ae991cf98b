#include "experiments/record/frame_json.h"

#include <cmath>
#include <limits>
#include <string>

#include "experiments/record/counter_columns.h"

namespace raymeter {

namespace {

using Json = nlohmann::ordered_json;

/// JSON has no infinity: what is not finite, as the error of an image that is not, is null, and infinite when read.
Json finite_json(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
double number_from_json(const nlohmann::json& json) { return json.is_null() ? std::numeric_limits<double>::infinity() : json.get<double>(); }

RayCounts rays_from_json(const nlohmann::json& json) {
  return {json.at("primary"),        json.at("primary_hit"), json.at("reflection"), json.at("reflection_hit"), json.at("refraction"),
          json.at("refraction_hit"), json.at("tir"),         json.at("shadow"),     json.at("shadow_blocked")};
}

}  // namespace

Json to_json(const RayCounts& rays) {
  return {{"primary", rays.primary},
          {"primary_hit", rays.primary_hit},
          {"reflection", rays.reflection},
          {"reflection_hit", rays.reflection_hit},
          {"refraction", rays.refraction},
          {"refraction_hit", rays.refraction_hit},
          {"tir", rays.tir},
          {"shadow", rays.shadow},
          {"shadow_blocked", rays.shadow_blocked}};
}

Json to_json(const FrameRecord& record) {
  Json counters = Json::object();
  for (const FramePhase phase : kFramePhases) counters[std::string(name(phase))] = to_json(record.counters[static_cast<std::size_t>(phase)]);
  return {{"rays", to_json(record.rays)},
          {"generations", record.depth.generation},
          {"deepest_sum", record.depth.deepest_sum},
          {"rays_full", record.rays_full},
          {"rmse", finite_json(record.error.rmse)},
          {"ssim", record.error.ssim ? finite_json(*record.error.ssim) : Json(nullptr)},
          {"error_mean", finite_json(record.bound.error_mean)},
          {"error_max", finite_json(record.bound.error_max)},
          {"bound_mean", finite_json(record.bound.bound_mean)},
          {"bound_max", finite_json(record.bound.bound_max)},
          {"bound_exceeded", record.bound.exceeded},
          {"counters", counters}};
}

FrameRecord frame_from_json(const nlohmann::json& json) {
  FrameRecord record;
  record.rays = rays_from_json(json.at("rays"));
  json.at("generations").get_to(record.depth.generation);
  record.depth.deepest_sum = json.at("deepest_sum");
  record.rays_full = json.at("rays_full");
  record.error.rmse = number_from_json(json.at("rmse"));
  if (!json.at("ssim").is_null()) record.error.ssim = json.at("ssim").get<double>();
  record.bound = {number_from_json(json.at("error_mean")), number_from_json(json.at("error_max")), number_from_json(json.at("bound_mean")),
                  number_from_json(json.at("bound_max")), json.at("bound_exceeded")};
  for (const FramePhase phase : kFramePhases) {
    record.counters[static_cast<std::size_t>(phase)] = counters_from_json(json.at("counters").at(std::string(name(phase))));
  }
  return record;
}

Json to_json(const PhaseSamples& phases) {
  Json json = Json::object();
  for (const FramePhase phase : kFramePhases) {
    const PhaseSample& sample = phases[static_cast<std::size_t>(phase)];
    json[std::string(name(phase))] = {{"ms", sample.ms}, {"rays", sample.rays}};
  }
  return json;
}

PhaseSamples phases_from_json(const nlohmann::json& json) {
  PhaseSamples phases;
  for (const FramePhase phase : kFramePhases) {
    const nlohmann::json& one = json.at(std::string(name(phase)));
    phases[static_cast<std::size_t>(phase)] = {one.at("ms"), one.at("rays")};
  }
  return phases;
}

}  // namespace raymeter
