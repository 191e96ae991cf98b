#include "experiments/record/compare.h"

#include <algorithm>
#include <fstream>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "experiments/record/counter_columns.h"
#include "experiments/record/run_folder.h"
#include "experiments/record/run_log.h"
#include "experiments/record/tables.h"

namespace raymeter {

namespace {

struct PlannedCell {
  std::string id;
  std::string scene;
  std::string what;
  nlohmann::json params;
};

std::vector<PlannedCell> read_plan(const std::filesystem::path& folder) {
  std::ifstream file(folder / "plan.jsonl");
  if (!file) throw Error(folder.string() + ": no plan.jsonl, expected the results of a run");
  std::vector<PlannedCell> cells;
  try {
    for (std::string line; std::getline(file, line);) {
      const nlohmann::json cell = nlohmann::json::parse(line);
      std::string params;
      for (const auto& [key, value] : cell.at("params").items()) {
        params += fmt::format("{}{}={}", params.empty() ? ":" : ",", key, value.is_string() ? value.get<std::string>() : value.dump());
      }
      const auto text = [&](const char* key) { return cell.at(key).get<std::string>(); };
      for (const auto& [slot, usual] : {std::pair{"first_hit", "cast"}, std::pair{"occlusion", "none"}}) {
        if (text(slot) != usual) params.append("+").append(text(slot));
      }
      std::string what = fmt::format("{} {}{} {} packet {} {} threads {}", text("scene"), text("structure"), params, text("isa"), cell.at("packet").dump(),
                                     text("rays"), text("threads"));
      if (text("rays") == "image") what += fmt::format(" max_depth {} min_weight {}", cell.at("max_depth").dump(), cell.at("min_weight").dump());
      cells.push_back({text("cell"), text("scene"), what, cell.at("params")});
    }
  } catch (const nlohmann::json::exception&) {
    throw Error((folder / "plan.jsonl").string() + ": not a plan");
  }
  return cells;
}

struct Run {
  std::vector<PlannedCell> plan;
  RunRecords records;
  Manifest manifest;

  explicit Run(const std::filesystem::path& folder) : plan(read_plan(folder)), records(read_run_log(folder / "samples.jsonl")) {
    const std::optional<Manifest> found = read_manifest(folder);
    if (!found) throw Error(folder.string() + ": no manifest.json, expected the results of a run");
    manifest = *found;
  }
  /// The cell's record with its scene's contents in the key; cells that were not traced have none.
  [[nodiscard]] std::map<std::string, const PlannedCell*> checked() const {
    std::map<std::string, const PlannedCell*> cells;
    for (const PlannedCell& cell : plan) {
      const auto check = records.checks.find(cell.id);
      const auto scene = records.scenes.find(cell.scene);
      if (check != records.checks.end() && check->second.counters && scene != records.scenes.end()) cells[cell.id + "-" + scene->second.hash] = &cell;
    }
    return cells;
  }
};

std::vector<std::string> changes(const CheckRecord& base, const CheckRecord& with) {
  std::vector<std::string> changed;
  if (base.hit_hash != with.hit_hash) changed.emplace_back(base.frame ? "image" : "hits");
  const nlohmann::json a = to_json(*base.counters);
  const nlohmann::json b = to_json(*with.counters);
  for (const auto& [name, value] : a.items()) {
    if (value != b.at(name)) changed.push_back(fmt::format("{} {} -> {}", name, value.dump(), b.at(name).dump()));
  }
  return changed;
}

/// A cell's id leaves out parameters at their defaults: where a default has changed, one id means two settings.
void add_changed_defaults(const PlannedCell& base, const PlannedCell& with, std::vector<std::string>& changed) {
  for (const auto& [key, value] : base.params.items()) {
    if (with.params.contains(key) && with.params.at(key) != value) changed.push_back(fmt::format("{} {} -> {}", key, value.dump(), with.params.at(key).dump()));
  }
}

CellComparison compare_cells(const Run& base, const Run& with, const PlannedCell& cell, const PlannedCell& same_cell) {
  CellComparison result{cell.what, {}, {}, changes(base.records.checks.at(cell.id), with.records.checks.at(cell.id))};
  add_changed_defaults(cell, same_cell, result.changed);
  const std::vector<double> before = ns_per_ray(base.records, cell.id);
  const std::vector<double> after = ns_per_ray(with.records, cell.id);
  if (before.empty() || after.empty() || median(before) <= 0) return result;
  result.ratio = median(after) / median(before);
  const std::optional<Interval> from = median_interval(before);
  const std::optional<Interval> to = median_interval(after);
  if (from && to && from->lo > 0) result.interval = Interval{to->lo / from->hi, to->hi / from->lo};
  return result;
}

}  // namespace

RunComparison compare_runs(const std::filesystem::path& base_folder, const std::filesystem::path& new_folder) {
  const Run base(base_folder);
  const Run with(new_folder);
  RunComparison result;
  result.same_machine = base.manifest.cpu == with.manifest.cpu && base.manifest.host == with.manifest.host;
  const auto before = base.checked();
  const auto after = with.checked();
  std::vector<double> ratios;
  for (const PlannedCell& cell : base.plan) {
    const auto found = std::find_if(before.begin(), before.end(), [&](const auto& entry) { return entry.second == &cell; });
    if (found == before.end()) continue;
    const auto same_cell = after.find(found->first);
    if (same_cell == after.end()) {
      ++result.only_base;
      continue;
    }
    result.cells.push_back(compare_cells(base, with, cell, *same_cell->second));
    if (result.cells.back().ratio) ratios.push_back(*result.cells.back().ratio);
  }
  result.only_new = after.size() - result.cells.size();
  if (!ratios.empty()) result.geomean = geometric_mean(ratios);
  return result;
}

}  // namespace raymeter
