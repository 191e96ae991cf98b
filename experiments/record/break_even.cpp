#include "experiments/record/break_even.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>

#include <fmt/format.h>

#include "accel/registry.h"
#include "experiments/atomic_file.h"
#include "experiments/record/metrics.h"
#include "experiments/record/statistics.h"
#include "experiments/record/tables.h"

namespace raymeter {

namespace {

/// Scene, rays and setting: what techniques have to share to be compared.
auto surroundings(const Experiment& e) {
  return std::tuple(e.scene.name, e.rays.name, e.isa, e.packet, e.threads, technique_text(e.first_hit), technique_text(e.occlusion), e.max_depth, e.min_weight,
                    e.general);
}

std::optional<Price> price_of(const Experiment& cell, const RunRecords& records) {
  const auto build = records.builds.find({cell.scene.name, build_text(cell), cell.threads});
  const std::vector<double> times = ns_per_ray(records, cell.id);
  if (build == records.builds.end() || times.empty()) return std::nullopt;
  return Price{median(build->second.build_ms), median(times)};
}

bool is_plain_list(const Experiment& e) { return e.structure->name == "list" && field(e, "structure.volume") == "none"; }

}  // namespace

std::string break_even(const Price& price, const Price& other) {
  const double dearer = price.build_ms - other.build_ms, saved = other.ns_per_ray - price.ns_per_ray;
  if (saved < 0 || (saved == 0 && dearer >= 0)) return "never";
  if (dearer <= 0) return "always";
  return fmt::format("{:.9g}", std::ceil(dearer * 1e6 / saved));
}

std::string break_even_with_list(const std::vector<Experiment>& cells, const Experiment& cell, const RunRecords& records) {
  if (is_plain_list(cell)) return {};
  const auto beside = [&](const Experiment& e) { return is_plain_list(e) && surroundings(e) == surroundings(cell); };
  const auto list = std::find_if(cells.begin(), cells.end(), beside);
  if (list == cells.end()) return {};
  const std::optional<Price> price = price_of(cell, records), list_price = price_of(*list, records);
  return price && list_price ? break_even(*price, *list_price) : std::string();
}

void write_break_even(const std::filesystem::path& folder, const std::vector<Experiment>& cells, const RunRecords& records) {
  struct Priced {
    std::string cell_id;
    Price price;
  };
  std::map<decltype(surroundings(cells.front())), std::vector<Priced>> groups;
  for (const Experiment& cell : cells) {
    if (const std::optional<Price> price = price_of(cell, records)) groups[surroundings(cell)].push_back({cell_id(cell, records), *price});
  }
  std::string text = fmt::format("{}\n", fmt::join(columns(Table::break_even), ","));
  for (const auto& [setting, group] : groups) {
    for (const Priced& one : group) {
      for (const Priced& other : group) {
        if (&one != &other) text += fmt::format("{},{},{}\n", one.cell_id, other.cell_id, break_even(one.price, other.price));
      }
    }
  }
  AtomicFile file((folder / "break_even.csv").string());
  file.write(text);
  file.commit();
}

}  // namespace raymeter
