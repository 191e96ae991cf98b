// Rows of summary.csv.

#include "experiments/record/statistics.h"
#include "experiments/record/table_source.h"
#include "experiments/record/tables.h"

namespace raymeter {

namespace {

/// Ratios of the samples that a cell and its reference took in the same round.
std::vector<double> paired_ratios(const RunRecords& records, const std::string& cell, const std::string& reference, const RowPhase& phase) {
  if (ns_per_ray(records, cell, phase.part).empty() || ns_per_ray(records, reference, phase.part).empty()) return {};
  std::vector<double> ratios;
  const std::map<int, SampleRecord>& others = records.samples.at(reference);
  for (const auto& [index, sample] : records.samples.at(cell)) {
    const auto other = others.find(index);
    if (other == others.end()) continue;
    const double other_ms = part_of(other->second, phase.part).ms;
    if (other_ms > 0) ratios.push_back(part_of(sample, phase.part).ms / other_ms);
  }
  return ratios;
}

/// Build and one frame; empty but for whole images.
std::string time_to_image_ms(const Source& source, const Experiment& cell, const RowPhase& phase) {
  const BuildRecord* const build = source.build(cell);
  if (!cell.rays.image() || phase.part || build == nullptr || ns_per_ray(source.records, cell.id).empty()) return {};
  std::vector<double> frames;
  for (const auto& [index, sample] : source.records.samples.at(cell.id)) frames.push_back(sample.trace_ms);
  return number(median(build->build_ms) + median(frames));
}

/// Of the times per ray: their number, median, its interval, deviation and speed.
Row time_fields(const std::vector<double>& times) {
  Row row{std::to_string(times.size())};
  if (times.empty()) {
    row.resize(6);
    return row;
  }
  const std::optional<Interval> interval = median_interval(times);
  const double middle = median(times);
  row.insert(row.end(), {number(middle), interval ? number(interval->lo) : "", interval ? number(interval->hi) : "", number(median_deviation(times)),
                         middle > 0 ? number(1e3 / middle) : ""});
  return row;
}

}  // namespace

void add_summary_rows(const Source& source, const Experiment& cell, const RowPhase& phase, const AddRow& add) {
  const BuildRecord* const build = source.build(cell);
  const CheckRecord* const check = source.check(cell);
  Row row = time_fields(ns_per_ray(source.records, cell.id, phase.part));
  row.push_back(build != nullptr ? number(median(build->build_ms)) : "");
  row.push_back(time_to_image_ms(source, cell, phase));
  row.push_back(build != nullptr ? number(static_cast<std::int64_t>(build->stats.mem_bytes)) : "");
  for (std::string& average : counter_averages(cell, source.counters(cell, phase))) row.push_back(std::move(average));
  const std::optional<std::size_t> reference = source.references[static_cast<std::size_t>(&cell - source.cells.data())];
  const std::vector<double> ratios = reference ? paired_ratios(source.records, cell.id, source.cells[*reference].id, phase) : std::vector<double>();
  const std::optional<Interval> interval = median_interval(ratios);
  row.push_back(ratios.empty() ? "" : number(median(ratios)));
  row.push_back(interval ? number(interval->lo) : "");
  row.push_back(interval ? number(interval->hi) : "");
  row.push_back(check != nullptr ? number(check->hit_mismatch) : "");
  row.emplace_back(name(source.records.status(cell.id, source.config.measure.samples)));
  add(std::move(row));
}

}  // namespace raymeter
