#include <cstdlib>
#include <iostream>

#include <unistd.h>

#include "core/base/error.h"
#include "experiments/cli/cli.h"

namespace raymeter {

namespace {

void add_commands(Cli& cli) {
  add_run(cli);
  add_validate(cli);
  add_plan(cli);
  add_list(cli);
  add_describe(cli);
  add_schema(cli);
  add_env(cli);
  add_image(cli);
  add_trace(cli);
  add_report(cli);
  add_compare(cli);
}

/// CLI11's own codes (100 and more) become 2; help and version stay 0.
ExitCode parse(Cli& cli, int argc, char** argv) {
  try {
    cli.app.parse(argc, argv);
    if (cli.action) return cli.action();
    std::cerr << cli.app.help();
    return ExitCode::usage;
  } catch (const CLI::ParseError& error) {
    return cli.app.exit(error, std::cout, std::cerr) == 0 ? ExitCode::success : ExitCode::usage;
  }
}

int run(int argc, char** argv) {
  ::setenv("HWLOC_HIDE_ERRORS", "2", 0);  // hwloc would write to stderr itself where it finds no /sys; what it does not find is left empty
  Cli cli;
  cli.out = &std::cout;
  cli.err = &std::cerr;
  cli.err_is_terminal = ::isatty(STDERR_FILENO) != 0;
  cli.color = cli.err_is_terminal && std::getenv("NO_COLOR") == nullptr;
  cli.arguments.assign(argv, argv + argc);
  cli.environment = [](const std::string& name) -> const char* { return std::getenv(name.c_str()); };
  add_commands(cli);
  const auto complain = [&](const char* what) { std::cerr << (cli.color ? "\x1b[31mraymeter:\x1b[0m " : "raymeter: ") << what << '\n'; };
  try {
    const ExitCode code = parse(cli, argc, argv);
    std::cout.flush();
    if (std::cout) return static_cast<int>(code);
    complain("standard output: write failed");
  } catch (const Error& error) {
    complain(error.what());
    return static_cast<int>(ExitCode::usage);
  } catch (const std::bad_alloc&) {
    complain("out of memory");
  } catch (const std::exception& error) {
    complain(error.what());
  }
  return static_cast<int>(ExitCode::failure);
}

}  // namespace

}  // namespace raymeter

int main(int argc, char** argv) { return raymeter::run(argc, argv); }
