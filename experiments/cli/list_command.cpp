#include <algorithm>
#include <map>
#include <memory>
#include <ostream>

#include <fmt/format.h>

#include "accel/registry.h"
#include "experiments/cases/hard_case.h"
#include "experiments/cli/cli.h"
#include "experiments/record/catalog.h"
#include "experiments/record/metrics.h"
#include "experiments/scenes/generators.h"

namespace raymeter {

namespace {

std::string techniques_table() {
  std::string text;
  for (const TechniqueInfo& t : techniques()) text += fmt::format("{:<20} {:<10} {} ({})\n", t.name, t.slot, t.summary, t.source);
  return text;
}

std::string scenes_table() {
  std::string text;
  for (const SceneGenerator& generator : scene_generators()) {
    text += fmt::format("{:<14} {} (:SIZE is the {}, {} to {}, default {})\n", generator.spec_prefix, generator.summary, generator.size_means,
                        generator.min_size, generator.max_size, generator.default_size);
  }
  for (const HardCase& row : hard_cases()) text += fmt::format("hard:{} {}\n", row.name, row.summary);
  return text;
}

std::string isas_table() {
  std::string text;
  for (const Isa isa : kIsas) {
    text += fmt::format("{:<8} {:>2} rays per register{}\n", name(isa), simd_width(isa), available(isa) ? "" : ", not on this machine");
  }
  return text;
}

std::string metrics_table() {
  std::string text;
  for (const Metric& metric : metrics()) text += fmt::format("{:<26} {:<9} {:<7} {}\n", metric.name, name(metric.table), name(metric.better), metric.help);
  return text;
}

struct Catalog {
  std::string (*table)();
  std::string (*json)();
};

std::string value_range(const ParamInfo& info) {
  if (std::holds_alternative<bool>(info.default_value)) return "true, false";
  if (std::holds_alternative<std::string>(info.default_value)) return info.choices.empty() ? "any text" : fmt::format("{}", fmt::join(info.choices, ", "));
  return number_range(info);
}

/// Which values of a parameter need no build of their own.
std::string shared_builds(const ParamInfo& info) {
  std::vector<std::string> groups;
  for (const auto& choices : info.same_build) groups.push_back(fmt::format("{}", fmt::join(choices, ", ")));
  if (info.use == ParamUse::query) return groups.empty() ? "; query" : fmt::format("; query for {}, else a build of its own", fmt::join(groups, "; "));
  return groups.empty() ? "" : fmt::format("; {} share a build", fmt::join(groups, " share a build; "));
}

std::string description(const TechniqueInfo& technique) {
  std::string text = fmt::format("{} ({}): {}\n{}\n", technique.name, technique.slot, technique.summary, technique.source);
  const std::vector<ParamInfo> infos = technique.params();
  if (infos.empty()) return text + "\nNo parameters.\n";
  const bool has_query = std::ranges::any_of(infos, [](const ParamInfo& info) { return info.use == ParamUse::query; });
  text += fmt::format("\nParameters, with (default) and range{}:\n", has_query ? "; one marked 'query' needs no new build" : "");
  for (const ParamInfo& info : infos) {
    text += fmt::format("  {:<22} ({}) {}{}\n  {:<22} {}\n", info.key, to_string(info.default_value), value_range(info), shared_builds(info), "", info.help);
  }
  return text;
}

}  // namespace

void add_list(Cli& cli) {
  struct Options {
    std::string what;
    bool json = false;
  };
  static const std::map<std::string, Catalog> catalogs{{"techniques", {techniques_table, techniques_json}},
                                                       {"scenes", {scenes_table, scenes_json}},
                                                       {"isas", {isas_table, isas_json}},
                                                       {"metrics", {metrics_table, metrics_json}}};
  auto options = std::make_shared<Options>();
  CLI::App& command = cli.add_command("list", "raymeter list techniques", "Lists what there is to choose from, one name a line.");
  command.add_option("what", options->what, "techniques, scenes, isas or metrics")->required()->check(CLI::IsMember(&catalogs));
  command.add_flag("--json", options->json, "Print JSON");
  command.callback([&cli, options] {
    cli.action = [&cli, options] {
      const Catalog& catalog = catalogs.at(options->what);
      *cli.out << (options->json ? catalog.json() + "\n" : catalog.table());
      return ExitCode::success;
    };
  });
}

void add_describe(Cli& cli) {
  struct Options {
    std::string technique;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App& command = cli.add_command("describe", "raymeter describe bvh", "Describes a technique and its parameters.");
  command.add_option("technique", options->technique, "Its name")->required();
  command.add_flag("--json", options->json, "Print JSON");
  command.callback([&cli, options] {
    cli.action = [&cli, options] {
      const TechniqueInfo technique = technique_info(options->technique);
      *cli.out << (options->json ? technique_json(technique) + "\n" : description(technique));
      return ExitCode::success;
    };
  });
}

}  // namespace raymeter
