#include "experiments/cli/config_options.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

namespace raymeter {

void ConfigOptions::add_to(CLI::App& command) {
  command.add_option("config", path, "Experiment description, see 'raymeter schema'")->required();
  command.add_option("--set", settings, "Override a key of the config, e.g. measure.samples=3 or matrix.packet=[1,8]")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  command.add_option("--filter", filter, "Only the cells that match, e.g. 'structure=bvh*;scene=spd:balls*'");
  command.add_option("--shard", shard, "Only every N-th scene, from the I-th on")->type_name("I/N");
}

std::vector<Experiment> ConfigOptions::cells(const Config& config) const {
  return expand(config, parse_filter(filter), shard.empty() ? Shard{} : parse_shard(shard));
}

std::string plan_table(const Config& config, const std::vector<Experiment>& cells) {
  // Images differ in depths too.
  const auto rays = [](const Experiment& cell) {
    return cell.rays.image() ? fmt::format("image {} {}", cell.max_depth, to_string(ParamValue(cell.min_weight))) : cell.rays.name;
  };
  const auto row = [](const auto&... fields) { return fmt::format("{:<16}  {:<22} {:<18} {:<7} {:>6}  {:>7}  {}\n", fields...); };
  std::string text = row("cell", "scene", "rays", "isa", "packet", "threads", "structure");
  std::set<std::string> scenes;
  for (const Experiment& cell : cells) {
    text += row(cell.id, cell.scene.name, rays(cell), name(cell.isa), cell.packet, threads_text(cell.threads), technique_text(cell));
    scenes.insert(cell.scene.name);
  }
  const auto missing = std::count_if(cells.begin(), cells.end(), [](const Experiment& cell) { return !available(cell.isa); });
  const auto absent = std::count_if(cells.begin(), cells.end(), [](const Experiment& cell) { return !cell.scene.absent.empty(); });
  text += fmt::format("{} cells of {} scenes, {} timed passes each", cells.size(), scenes.size(), config.measure.samples);
  if (missing > 0) text += fmt::format("; {} will be skipped: this machine lacks their instruction set", missing);
  if (absent > 0) text += fmt::format("; {} will be skipped: their scene is not there", absent);
  return text + "\n";
}

}  // namespace raymeter
