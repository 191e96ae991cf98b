#include "experiments/record/tables.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <fmt/format.h>

#include "experiments/atomic_file.h"
#include "experiments/config/expand.h"
#include "experiments/record/break_even.h"
#include "experiments/record/google_benchmark.h"
#include "experiments/record/metrics.h"
#include "experiments/record/statistics.h"
#include "experiments/record/table_source.h"

namespace raymeter {

namespace {

/// A field of RFC 4180.
std::string quoted_field(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

Row key_fields(const Source& source, const Experiment& e, std::string_view phase) {
  const SceneRecord* const scene = source.scene(e);
  const CheckRecord* const check = source.check(e);
  return {cell_id(e, source.records),
          e.scene.name,
          scene != nullptr ? std::to_string(scene->num_prims) : "",
          e.general          ? "all"
          : scene != nullptr ? scene->needs
                             : "",
          e.rays.name,
          std::string(phase),
          std::string(e.structure->name),
          params_text(e.params) + (check != nullptr && !check->choice.empty() ? "; " + check->choice : ""),
          technique_text(e.first_hit),
          technique_text(e.occlusion),
          std::to_string(e.max_depth),
          to_string(ParamValue(e.min_weight)),
          std::string(name(e.isa)),
          std::to_string(simd_width(e.isa)),
          std::to_string(e.packet),
          check != nullptr ? std::to_string(check->threads) : threads_text(e.threads)};
}

/// What a table tells of separately in a cell.
std::vector<RowPhase> row_phases(Table table, const Source& source, const Experiment& cell) {
  if (table == Table::builds) return {{"build", {}}};
  std::vector<RowPhase> phases = source.phases(cell);
  if (table == Table::accuracy || table == Table::frames) phases.resize(1);
  return phases;
}

using AddRows = void (*)(const Source&, const Experiment&, const RowPhase&, const AddRow&);

void write_table(const std::filesystem::path& folder, Table table, const Source& source, AddRows add_rows) {
  const std::vector<std::string_view> header = columns(table);
  std::string text = fmt::format("{}\n", fmt::join(header, ","));
  for (const Experiment& cell : source.cells) {
    for (const RowPhase& phase : row_phases(table, source, cell)) {
      add_rows(source, cell, phase, [&](const Row& row) {
        Row fields = key_fields(source, cell, phase.name);
        fields.insert(fields.end(), row.begin(), row.end());
        assert(fields.size() == header.size());
        for (std::size_t i = 0; i < fields.size(); ++i) text.append(i > 0 ? "," : "").append(quoted_field(fields[i]));
        text += '\n';
      });
    }
  }
  AtomicFile file((folder / fmt::format("{}.csv", name(table))).string());
  file.write(text);
  file.commit();
}

}  // namespace

void add_build_rows(const Source& source, const Experiment& cell, const RowPhase&, const AddRow& add) {
  const BuildRecord* const build = source.build(cell);
  const SceneRecord* const scene = source.scene(cell);
  if (build == nullptr || scene == nullptr) return;
  const BuildStats& s = build->stats;
  const double prims = scene->num_prims;
  const auto scene_bytes = static_cast<double>(scene->scene_bytes);
  const double build_ms = median(build->build_ms);
  const std::optional<Interval> interval = median_interval(build->build_ms);
  add({number(build_ms),
       prims > 0 && build_ms > 0 ? number(prims / (build_ms * 1e3)) : "",
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
       break_even_with_list(source.cells, cell, source.records),
       number(static_cast<std::int64_t>(scene->scene_bytes)),
       number(s.sibling_distance),
       number(s.node_volume),
       number(s.total_volume),
       number(s.cost_depth),
       number(s.cost_depth_p90),
       number(s.epo_se),
       number(s.volume_area),
       number(s.void_area),
       number(static_cast<std::int64_t>(build->build_ms.size())),
       interval ? number(interval->lo) : "",
       interval ? number(interval->hi) : ""});
}

std::string cell_id(const Experiment& cell, const RunRecords& records) {
  const auto scene = records.scenes.find(cell.scene.name);
  return scene == records.scenes.end() ? cell.id : cell.id + "-" + scene->second.hash;
}

std::string build_text(const Experiment& cell) {
  ParamValues params;
  const std::vector<ParamInfo> infos = cell.structure->params();
  for (const auto& [key, value] : cell.params) {
    const std::string& name = key;  // clang 14 captures no structured bindings
    const auto info = std::find_if(infos.begin(), infos.end(), [&](const ParamInfo& one) { return one.key == name; });
    if (info == infos.end()) continue;
    const std::string written = to_string(value);
    const auto same = std::ranges::find_if(info->same_build, [&](const auto& choices) { return std::ranges::find(choices, written) != choices.end(); });
    if (info->use == ParamUse::query && (info->same_build.empty() || same != info->same_build.end())) continue;
    params.emplace_back(key, same == info->same_build.end() ? value : ParamValue(fmt::format("{}", fmt::join(*same, "|"))));
  }
  const std::string text = params_text(params);
  return std::string(cell.structure->name) + (text.empty() ? "" : ":" + text);
}

std::vector<double> ns_per_ray(const RunRecords& records, const std::string& cell, const std::optional<FramePhase>& phase) {
  std::vector<double> times;
  const auto samples = records.samples.find(cell);
  if (samples == records.samples.end()) return times;
  for (const auto& [index, sample] : samples->second) {
    if (!sample.ok) return {};
    const PhaseSample part = part_of(sample, phase);
    if (part.rays > 0) times.push_back(part.ms * 1e6 / static_cast<double>(part.rays));
  }
  return times;
}

void write_tables(const std::filesystem::path& folder, const Config& config, const std::vector<Experiment>& cells, const RunRecords& records) {
  const Source source{config, cells, records, reference_cells(config, cells)};
  write_table(folder, Table::samples, source, add_sample_rows);
  write_table(folder, Table::builds, source, add_build_rows);
  write_table(folder, Table::counters, source, add_counter_rows);
  write_table(folder, Table::accuracy, source, add_accuracy_rows);
  write_table(folder, Table::frames, source, add_frame_rows);
  write_table(folder, Table::summary, source, add_summary_rows);
  write_break_even(folder, cells, records);
  AtomicFile file((folder / "benchmark.json").string());
  file.write(google_benchmark_json(cells, records));
  file.commit();
}

}  // namespace raymeter
