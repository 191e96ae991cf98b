#include "experiments/record/tables.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <tuple>

#include <fmt/format.h>

#include "experiments/atomic_file.h"
#include "experiments/config/expand.h"
#include "experiments/record/counter_columns.h"
#include "experiments/record/google_benchmark.h"
#include "experiments/record/metrics.h"
#include "experiments/record/statistics.h"

namespace raymeter {

namespace {

using Row = std::vector<std::string>;

/// What is derived from; one cell's part of it is found by the functions below.
struct Source {
  const Config& config;
  const std::vector<Experiment>& cells;
  const RunRecords& records;
  std::vector<std::optional<std::size_t>> references;

  [[nodiscard]] const CheckRecord* check(const Experiment& cell) const {
    const auto found = records.checks.find(cell.id);
    return found == records.checks.end() ? nullptr : &found->second;
  }
  [[nodiscard]] const SceneRecord* scene(const Experiment& cell) const {
    const auto found = records.scenes.find(cell.scene.name);
    return found == records.scenes.end() ? nullptr : &found->second;
  }
  [[nodiscard]] const BuildRecord* build(const Experiment& cell) const {
    const auto found = records.builds.find({cell.scene.name, build_text(cell), cell.threads});
    return found == records.builds.end() ? nullptr : &found->second;
  }
};

std::string number(double value) { return fmt::format("{:.9g}", value); }
std::string number(std::int64_t value) { return std::to_string(value); }

template <class T>
std::string number(const std::optional<T>& value) {
  return value ? number(*value) : std::string();
}

/// A field of RFC 4180.
std::string quoted_field(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

std::string phase(const Experiment& cell) {
  const bool any = cell.rays.any || cell.rays.name == "shadow" || cell.rays.name == "ambient_occlusion";
  return any ? "any" : "closest";
}

Row key_fields(const Source& source, const Experiment& e, const std::string& phase_name) {
  const SceneRecord* const scene = source.scene(e);
  const CheckRecord* const check = source.check(e);
  return {cell_id(e, source.records),
          e.scene.name,
          scene != nullptr ? std::to_string(scene->num_prims) : "",
          scene != nullptr ? scene->needs : "",
          e.rays.name,
          phase_name,
          std::string(e.structure->name),
          params_text(e.params),
          technique_text(e.first_hit),
          technique_text(e.occlusion),
          std::to_string(e.max_depth),
          to_string(ParamValue(e.min_weight)),
          std::string(name(e.isa)),
          std::to_string(simd_width(e.isa)),
          std::to_string(e.packet),
          check != nullptr ? std::to_string(check->threads) : threads_text(e.threads)};
}

void add_sample_rows(const Source& source, const Experiment& cell, const std::function<void(Row)>& add) {
  const auto samples = source.records.samples.find(cell.id);
  if (samples == source.records.samples.end()) return;
  for (const auto& [index, sample] : samples->second) {
    const auto rays = static_cast<double>(sample.rays);
    const bool timed = sample.ok && sample.rays > 0 && sample.trace_ms > 0;
    add({number(std::int64_t{index}), number(sample.order_index), sample.ok ? number(sample.trace_ms) : "", number(sample.rays),
         timed ? number(rays / (sample.trace_ms * 1e3)) : "", timed ? number(sample.trace_ms * 1e6 / rays) : "", sample.ok ? "ok" : "wrong"});
  }
}

/// Rays after which a build has paid off against another structure: n = (B1 - B2) / (c2 - c1) with build times B and times per ray c.
std::string break_even(double build_ms, double ns_per_ray, double other_build_ms, double other_ns_per_ray) {
  if (!(ns_per_ray < other_ns_per_ray)) return "never";
  if (build_ms <= other_build_ms) return "always";
  return number(std::ceil((build_ms - other_build_ms) * 1e6 / (other_ns_per_ray - ns_per_ray)));
}

/// The list in the cell's scene, rays and setting; null where the run has none, or the cell is one itself.
const Experiment* list_beside(const Source& source, const Experiment& cell) {
  if (cell.structure->name == "list") return nullptr;
  const auto key = [](const Experiment& e) {
    return std::tie(e.scene.name, e.rays.name, e.isa, e.packet, e.threads, e.first_hit, e.occlusion, e.max_depth, e.min_weight);
  };
  const auto found =
      std::find_if(source.cells.begin(), source.cells.end(), [&](const Experiment& e) { return e.structure->name == "list" && key(e) == key(cell); });
  return found == source.cells.end() ? nullptr : &*found;
}

std::string break_even_with_list(const Source& source, const Experiment& cell) {
  const Experiment* const list = list_beside(source, cell);
  if (list == nullptr || source.build(*list) == nullptr) return {};
  const std::vector<double> times = ns_per_ray(source.records, cell.id), list_times = ns_per_ray(source.records, list->id);
  if (times.empty() || list_times.empty()) return {};
  return break_even(source.build(cell)->build_ms, median(times), source.build(*list)->build_ms, median(list_times));
}

void add_build_rows(const Source& source, const Experiment& cell, const std::function<void(Row)>& add) {
  const BuildRecord* const build = source.build(cell);
  const SceneRecord* const scene = source.scene(cell);
  if (build == nullptr || scene == nullptr) return;
  const BuildStats& s = build->stats;
  const double prims = scene->num_prims;
  const auto scene_bytes = static_cast<double>(scene->scene_bytes);
  add({number(build->build_ms),
       prims > 0 && build->build_ms > 0 ? number(prims / (build->build_ms * 1e3)) : "",
       number(s.nodes()),
       number(s.interior_nodes),
       number(s.leaves),
       number(s.empty_leaves),
       number(s.references),
       number(s.max_depth),
       number(s.sah_cost),
       number(s.epo),
       number(static_cast<std::int64_t>(s.mem_bytes)),
       prims > 0 ? number((static_cast<double>(s.mem_bytes) + scene_bytes) / prims) : "",
       break_even_with_list(source, cell),
       number(static_cast<std::int64_t>(scene->scene_bytes)),
       number(s.sibling_distance),
       number(s.node_volume),
       number(s.total_volume),
       number(s.cost_depth),
       number(s.cost_depth_p90),
       number(s.epo_se),
       number(s.volume_area),
       number(s.void_area)});
}

/// The per-ray averages that counters.csv and summary.csv share; empty where nothing was counted.
Row counter_averages(const Experiment& cell, const CheckRecord* check) {
  if (check == nullptr || !check->counters) return Row(3);
  const Counters& c = *check->counters;
  const auto rays = static_cast<double>(c.ray_count);
  if (c.ray_count == 0) return Row(3);
  return {number(static_cast<double>(c.live(Event::node_visit)) / rays), number(static_cast<double>(c.live(Event::prim_test)) / rays),
          number(simd_utilization(c, simd_width(cell.isa)))};
}

void add_counter_rows(const Source& source, const Experiment& cell, const std::function<void(Row)>& add) {
  const CheckRecord* const check = source.check(cell);
  if (check == nullptr || !check->counters) return;
  Row row{std::to_string(check->counters->ray_count)};
  for (const std::uint64_t sum : check->counters->rays) row.push_back(std::to_string(sum));
  for (const std::uint64_t sum : check->counters->packets) row.push_back(std::to_string(sum));
  for (std::string& average : counter_averages(cell, check)) row.push_back(std::move(average));
  add(std::move(row));
}

void add_accuracy_rows(const Source& source, const Experiment& cell, const std::function<void(Row)>& add) {
  const CheckRecord* const check = source.check(cell);
  if (check == nullptr || !check->accuracy) return;
  const AccuracyRecord& a = *check->accuracy;
  add({number(a.rays_checked), number(a.false_miss), number(a.false_hit), number(a.wrong_prim), "", number(a.t_ulp_p50), number(a.t_ulp_p99),
       number(a.t_ulp_max), "", "", ""});
}

/// Ratios of the samples that a cell and its reference took in the same round.
std::vector<double> paired_ratios(const RunRecords& records, const std::string& cell, const std::string& reference) {
  if (ns_per_ray(records, cell).empty() || ns_per_ray(records, reference).empty()) return {};
  std::vector<double> ratios;
  const std::map<int, SampleRecord>& others = records.samples.at(reference);
  for (const auto& [index, sample] : records.samples.at(cell)) {
    const auto other = others.find(index);
    if (other != others.end() && other->second.trace_ms > 0) ratios.push_back(sample.trace_ms / other->second.trace_ms);
  }
  return ratios;
}

void add_summary_rows(const Source& source, const Experiment& cell, const std::function<void(Row)>& add) {
  const std::vector<double> times = ns_per_ray(source.records, cell.id);
  const BuildRecord* const build = source.build(cell);
  const CheckRecord* const check = source.check(cell);
  Row row{std::to_string(times.size())};
  if (times.empty()) {
    row.resize(6);
  } else {
    const std::optional<Interval> interval = median_interval(times);
    const double middle = median(times);
    for (const std::string& field : {number(middle), interval ? number(interval->lo) : "", interval ? number(interval->hi) : "",
                                     number(median_deviation(times)), middle > 0 ? number(1e3 / middle) : ""}) {
      row.push_back(field);
    }
  }
  row.push_back(build != nullptr ? number(build->build_ms) : "");
  row.emplace_back();  // time_to_image_ms: whole images are not measured
  row.push_back(build != nullptr ? number(static_cast<std::int64_t>(build->stats.mem_bytes)) : "");
  for (std::string& average : counter_averages(cell, check)) row.push_back(std::move(average));
  const std::optional<std::size_t> reference = source.references[static_cast<std::size_t>(&cell - source.cells.data())];
  const std::vector<double> ratios = reference ? paired_ratios(source.records, cell.id, source.cells[*reference].id) : std::vector<double>();
  const std::optional<Interval> interval = median_interval(ratios);
  row.push_back(ratios.empty() ? "" : number(median(ratios)));
  row.push_back(interval ? number(interval->lo) : "");
  row.push_back(interval ? number(interval->hi) : "");
  row.push_back(check != nullptr ? number(check->hit_mismatch) : "");
  row.emplace_back(name(source.records.status(cell.id, source.config.measure.samples)));
  add(std::move(row));
}

using AddRows = void (*)(const Source&, const Experiment&, const std::function<void(Row)>&);

void write_table(const std::filesystem::path& folder, Table table, const Source& source, AddRows add_rows) {
  const std::vector<std::string_view> header = columns(table);
  std::string text = fmt::format("{}\n", fmt::join(header, ","));
  for (const Experiment& cell : source.cells) {
    add_rows(source, cell, [&](const Row& row) {
      Row fields = key_fields(source, cell, table == Table::builds ? "build" : phase(cell));
      fields.insert(fields.end(), row.begin(), row.end());
      assert(fields.size() == header.size());
      for (std::size_t i = 0; i < fields.size(); ++i) text.append(i > 0 ? "," : "").append(quoted_field(fields[i]));
      text += '\n';
    });
  }
  AtomicFile file((folder / fmt::format("{}.csv", name(table))).string());
  file.write(text);
  file.commit();
}

}  // namespace

std::string cell_id(const Experiment& cell, const RunRecords& records) {
  const auto scene = records.scenes.find(cell.scene.name);
  return scene == records.scenes.end() ? cell.id : cell.id + "-" + scene->second.hash;
}

std::string build_text(const Experiment& cell) {
  ParamValues params;
  const std::vector<ParamInfo> infos = cell.structure->params();
  for (std::size_t i = 0; i < infos.size(); ++i) {
    if (infos[i].use == ParamUse::build) params.push_back(cell.params[i]);
  }
  const std::string text = params_text(params);
  return std::string(cell.structure->name) + (text.empty() ? "" : ":" + text);
}

std::vector<double> ns_per_ray(const RunRecords& records, const std::string& cell) {
  std::vector<double> times;
  const auto samples = records.samples.find(cell);
  if (samples == records.samples.end()) return times;
  for (const auto& [index, sample] : samples->second) {
    if (!sample.ok) return {};
    if (sample.rays > 0) times.push_back(sample.trace_ms * 1e6 / static_cast<double>(sample.rays));
  }
  return times;
}

void write_tables(const std::filesystem::path& folder, const Config& config, const std::vector<Experiment>& cells, const RunRecords& records) {
  const Source source{config, cells, records, reference_cells(config, cells)};
  write_table(folder, Table::samples, source, add_sample_rows);
  write_table(folder, Table::builds, source, add_build_rows);
  write_table(folder, Table::counters, source, add_counter_rows);
  write_table(folder, Table::accuracy, source, add_accuracy_rows);
  write_table(folder, Table::summary, source, add_summary_rows);
  AtomicFile file((folder / "benchmark.json").string());
  file.write(google_benchmark_json(cells, records));
  file.commit();
}

}  // namespace raymeter
