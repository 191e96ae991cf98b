#include <memory>
#include <ostream>

#include "experiments/cli/cli.h"
#include "experiments/record/environment.h"

namespace raymeter {

void add_env(Cli& cli) {
  struct Options {
    bool check = false;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App& command = cli.add_command("env", "raymeter env --check", "Prints machine, build and what of them records keep.");
  command.add_flag("--check", options->check, "Warn of what makes times unsteady");
  command.add_flag("--json", options->json, "Print JSON");
  command.callback([&cli, options] {
    cli.action = [&cli, options] {
      *cli.out << (options->json ? environment_json() : environment_text());
      if (!options->check) return ExitCode::success;
      for (const std::string& source : noise_sources()) *cli.err << "warning: " << source << '\n';
      return ExitCode::success;
    };
  });
}

}  // namespace raymeter
