#include "experiments/record/record_json.h"

#include <array>
#include <cassert>

#include "experiments/record/build_json.h"
#include "experiments/record/counter_columns.h"
#include "experiments/record/frame_json.h"

namespace raymeter {

namespace {

using Json = nlohmann::ordered_json;

template <class T>
Json optional_json(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

template <class T>
std::optional<T> optional_value(const nlohmann::json& json) {
  return json.is_null() ? std::nullopt : std::optional<T>(json.get<T>());
}

Status status_from_name(const std::string& text) {
  for (const Status status : {Status::ok, Status::wrong, Status::skipped, Status::timeout, Status::failed, Status::refused}) {
    if (name(status) == text) return status;
  }
  throw std::invalid_argument(text);
}

Json to_json(const CellRecord& cells) {
  return {{"rays_checked", cells.rays_checked},
          {"rays_missing", cells.rays_missing},
          {"rays_at_risk", cells.rays_at_risk},
          {"cells_missed", cells.cells_missed},
          {"longest", cells.longest}};
}

CellRecord cells_from_json(const nlohmann::json& json) {
  return {json.at("rays_checked"), json.at("rays_missing"), json.at("rays_at_risk"), json.at("cells_missed"), json.at("longest")};
}

Json to_json(const AccuracyRecord& record) {
  return {{"rays_checked", record.rays_checked},
          {"false_miss", record.false_miss},
          {"false_hit", record.false_hit},
          {"wrong_prim", record.wrong_prim},
          {"self_hits", optional_json(record.self_hits)},
          {"t_ulp_p50", optional_json(record.t_ulp_p50)},
          {"t_ulp_p99", optional_json(record.t_ulp_p99)},
          {"t_ulp_max", optional_json(record.t_ulp_max)}};
}

AccuracyRecord accuracy_from_json(const nlohmann::json& json) {
  return {json.at("rays_checked"),
          json.at("false_miss"),
          json.at("false_hit"),
          json.at("wrong_prim"),
          optional_value<std::int64_t>(json.value("self_hits", nlohmann::json())),
          optional_value<double>(json.at("t_ulp_p50")),
          optional_value<double>(json.at("t_ulp_p99")),
          optional_value<double>(json.at("t_ulp_max"))};
}

SceneRecord scene_from_json(const nlohmann::json& json) {
  return {json.at("scene"), json.at("hash"), json.at("num_prims"), json.at("needs"), json.at("scene_bytes"), json.at("load_ms")};
}

BuildRecord build_from_json(const nlohmann::json& json) {
  return {json.at("scene"), json.at("build"), json.at("threads"), {json.at("build_ms").get<double>()}, build_stats_from_json(json.at("stats"))};
}

Json to_json(const DemandRecord& record) {
  return {{"first_prepare_ms", record.first_prepare_ms},
          {"cells", record.stats.cells},
          {"candidates", record.stats.candidates},
          {"bytes", record.stats.bytes},
          {"full_bytes", record.stats.full_bytes}};
}

DemandRecord demand_from_json(const nlohmann::json& json) {
  return {json.at("first_prepare_ms"), {json.at("cells"), json.at("candidates"), json.at("bytes"), json.at("full_bytes")}};
}

CheckRecord check_from_json(const nlohmann::json& json) {
  CheckRecord record{json.at("cell"),
                     status_from_name(json.at("status")),
                     json.at("reason"),
                     optional_value<std::int64_t>(json.at("rays")),
                     json.at("threads"),
                     json.at("hit_hash"),
                     optional_value<std::int64_t>(json.at("hit_mismatch")),
                     json.value("choice", ""),
                     std::nullopt,
                     std::nullopt,
                     std::nullopt,
                     std::nullopt};
  if (!json.at("counters").is_null()) record.counters = counters_from_json(json.at("counters"));
  if (!json.at("accuracy").is_null()) record.accuracy = accuracy_from_json(json.at("accuracy"));
  if (json.contains("frame")) record.frame = frame_from_json(json["frame"]);
  if (json.contains("hits")) record.hits = json["hits"].get<std::int64_t>();
  if (json.contains("demand")) record.demand = demand_from_json(json["demand"]);
  if (json.contains("cells")) record.cells = cells_from_json(json["cells"]);
  return record;
}

SampleRecord sample_from_json(const nlohmann::json& json) {
  SampleRecord record{json.at("cell"),     json.at("sample"), json.at("order_index"), json.at("prepare_ms"),
                      json.at("trace_ms"), json.at("cpu_ms"), json.at("rays"),        json.at("ok")};
  if (json.contains("phases")) record.phases = phases_from_json(json["phases"]);
  return record;
}

}  // namespace

Json to_json(const SceneRecord& record) {
  return {{"type", "scene"},          {"scene", record.scene},
          {"hash", record.hash},      {"num_prims", record.num_prims},
          {"needs", record.needs},    {"scene_bytes", record.scene_bytes},
          {"load_ms", record.load_ms}};
}

Json to_json(const BuildRecord& record) {
  assert(record.build_ms.size() == 1);
  return {{"type", "build"},
          {"scene", record.scene},
          {"build", record.build},
          {"threads", record.threads},
          {"build_ms", record.build_ms.front()},
          {"stats", to_json(record.stats)}};
}

Json to_json(const CheckRecord& record) {
  Json json{{"type", "check"},
            {"cell", record.cell},
            {"status", name(record.status)},
            {"reason", record.reason},
            {"rays", optional_json(record.rays)},
            {"threads", record.threads},
            {"hit_hash", record.hit_hash},
            {"hit_mismatch", optional_json(record.hit_mismatch)},
            {"choice", record.choice},
            {"counters", record.counters ? to_json(*record.counters) : Json(nullptr)},
            {"accuracy", record.accuracy ? to_json(*record.accuracy) : Json(nullptr)}};
  if (record.frame) json["frame"] = to_json(*record.frame);
  if (record.hits) json["hits"] = *record.hits;
  if (record.demand) json["demand"] = to_json(*record.demand);
  if (record.cells) json["cells"] = to_json(*record.cells);
  return json;
}

Json to_json(const SampleRecord& record) {
  Json json{{"type", "sample"},
            {"cell", record.cell},
            {"sample", record.sample},
            {"order_index", record.order_index},
            {"prepare_ms", record.prepare_ms},
            {"trace_ms", record.trace_ms},
            {"cpu_ms", record.cpu_ms},
            {"rays", record.rays},
            {"ok", record.ok}};
  if (record.phases) json["phases"] = to_json(*record.phases);
  return json;
}

Json to_json(const EndRecord& record) { return {{"type", "end"}, {"cell", record.cell}, {"status", name(record.status)}, {"reason", record.reason}}; }

bool add_record(const std::string& line, RunRecords& records) {
  try {
    const nlohmann::json json = nlohmann::json::parse(line);
    const std::string type = json.at("type");
    if (type == "scene")
      records.add(scene_from_json(json));
    else if (type == "build")
      records.add(build_from_json(json));
    else if (type == "check")
      records.add(check_from_json(json));
    else if (type == "sample")
      records.add(sample_from_json(json));
    else if (type == "end")
      records.add(EndRecord{json.at("cell"), status_from_name(json.at("status")), json.at("reason")});
    else
      return false;
    return true;
  } catch (const nlohmann::json::exception&) {
    return false;
  } catch (const std::invalid_argument&) {
    return false;
  }
}

}  // namespace raymeter
