// validate, plan and schema.

#include <memory>
#include <ostream>

#include <fmt/format.h>

#include "core/base/error.h"
#include "experiments/cli/config_options.h"
#include "experiments/config/schema.h"
#include "experiments/record/run_folder.h"

namespace raymeter {

namespace {

/// Says what is wrong with each config, and goes on to the next.
ExitCode validate(const Cli& cli, const std::vector<std::string>& paths) {
  ExitCode code = ExitCode::success;
  for (const std::string& path : paths) {
    try {
      const std::vector<Experiment> cells = expand(load_config(path, {}, cli.environment));
      *cli.out << fmt::format("{}: valid, {} cells\n", path, cells.size());
    } catch (const Error& error) {
      *cli.err << "raymeter: " << error.what() << '\n';
      code = ExitCode::usage;
    }
  }
  return code;
}

}  // namespace

void add_validate(Cli& cli) {
  auto paths = std::make_shared<std::vector<std::string>>();
  CLI::App& command = cli.add_command("validate", "raymeter validate configs/*.json", "Checks configs without running anything.");
  command.add_option("configs", *paths, "Configs")->required();
  command.callback([&cli, paths] { cli.action = [&cli, paths] { return validate(cli, *paths); }; });
}

void add_plan(Cli& cli) {
  struct Options {
    ConfigOptions config;
    std::string format = "table";
  };
  auto options = std::make_shared<Options>();
  CLI::App& command = cli.add_command("plan", "raymeter plan configs/quick.json", "Prints the cells that a config would measure.");
  options->config.add_to(command);
  command.add_option("--format", options->format, "table or json")->check(CLI::IsMember({"table", "json"}))->capture_default_str();
  command.callback([&cli, options] {
    cli.action = [&cli, options] {
      const Config config = options->config.load(cli);
      const std::vector<Experiment> cells = options->config.cells(config);
      *cli.out << (options->format == "json" ? plan_json(cells) : plan_table(config, cells));
      return ExitCode::success;
    };
  });
}

void add_schema(Cli& cli) {
  CLI::App& command = cli.add_command("schema", "raymeter schema > experiment.schema.json", "Prints the JSON Schema (draft-07) of configs.");
  command.callback([&cli] {
    cli.action = [&cli] {
      *cli.out << config_schema_text();
      return ExitCode::success;
    };
  });
}

}  // namespace raymeter
