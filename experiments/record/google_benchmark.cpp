#include "experiments/record/google_benchmark.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/threads.h"
#include "core/simd/isa.h"
#include "experiments/record/counter_columns.h"
#include "experiments/record/environment.h"
#include "experiments/record/tables.h"

namespace raymeter {

namespace {

using Json = nlohmann::ordered_json;

Json entry(const Experiment& cell, const CheckRecord& check, const SampleRecord& sample, int index, int repetitions) {
  std::string name = fmt::format("{}/{}/{}/packet:{}/{}/threads:{}", cell.scene.name, technique_text(cell), raymeter::name(cell.isa), cell.packet,
                                 cell.rays.name, check.threads);
  if (cell.rays.image()) name += fmt::format("/max_depth:{}/min_weight:{}", cell.max_depth, to_string(ParamValue(cell.min_weight)));
  const double rays_per_s = static_cast<double>(sample.rays) / (sample.trace_ms * 1e-3);
  Json json{{"name", name},
            {"family_index", index},
            {"per_family_instance_index", 0},
            {"run_name", name},
            {"run_type", "iteration"},
            {"repetitions", repetitions},
            {"repetition_index", sample.sample},
            {"threads", check.threads},
            {"iterations", 1},
            {"real_time", sample.trace_ms},
            {"cpu_time", sample.cpu_ms},
            {"time_unit", "ms"},
            {"items_per_second", rays_per_s}};
  if (sample.phases) {
    for (const FramePhase phase : kFramePhases) json[fmt::format("{}_ms", raymeter::name(phase))] = (*sample.phases)[static_cast<std::size_t>(phase)].ms;
  }
  if (check.counters && check.counters->ray_count > 0) {
    const auto rays = static_cast<double>(check.counters->ray_count);
    json["node_visits_per_ray"] = static_cast<double>(check.counters->live(Event::node_visit)) / rays;
    json["prim_tests_per_ray"] = static_cast<double>(check.counters->live(Event::prim_test)) / rays;
  }
  return json;
}

}  // namespace

std::string google_benchmark_json(const std::vector<Experiment>& cells, const RunRecords& records) {
  const Fingerprint here = fingerprint();
  Json benchmarks = Json::array();
  int index = 0;
  for (const Experiment& cell : cells) {
    const auto samples = records.samples.find(cell.id);
    if (samples == records.samples.end() || ns_per_ray(records, cell.id).empty()) continue;
    for (const auto& [number, sample] : samples->second) {
      benchmarks.push_back(entry(cell, records.checks.at(cell.id), sample, index, static_cast<int>(samples->second.size())));
    }
    ++index;
  }
  const Json json{{"context",
                   {{"date", utc_stamp()},
                    {"host_name", here.host},
                    {"executable", "raymeter"},
                    {"num_cpus", all_threads()},
                    {"library_build_type", here.release ? "release" : "debug"}}},
                  {"benchmarks", benchmarks}};
  return json.dump(1) + "\n";
}

}  // namespace raymeter
