#include "experiments/cli/cli.h"

#include <memory>

namespace raymeter {

namespace {

/// CLI11's help, with an example before everything else.
class ExampleFormatter final : public CLI::Formatter {
public:
  explicit ExampleFormatter(std::string example) : example_(std::move(example)) {}
  std::string make_description(const CLI::App* app) const override { return "Example: " + example_ + "\n\n" + CLI::Formatter::make_description(app); }

private:
  std::string example_;
};

}  // namespace

Cli::Cli() {
  app.description("Measures ray tracing acceleration techniques: the same rays, scenes and intersection code for all.");
  app.formatter(std::make_shared<ExampleFormatter>("raymeter run configs/quick.json"));
  app.require_subcommand(0, 1);
}

CLI::App& Cli::add_command(const std::string& name, const std::string& example, const std::string& description) {
  CLI::App* command = app.add_subcommand(name, description);
  command->formatter(std::make_shared<ExampleFormatter>(example));
  return *command;
}

}  // namespace raymeter
