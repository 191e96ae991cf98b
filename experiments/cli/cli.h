#pragma once

#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace raymeter {

/// What a command's exit status says.
enum class ExitCode : int {
  success = 0,        ///< also: nothing to do, improved
  failure = 1,        ///< something went wrong at run time
  usage = 2,          ///< command line, config or scene
  slower = 3,         ///< confirmed
  changed = 4,        ///< counters, hits or an image
  inconclusive = 5,   ///< only with --strict
  incomplete = 7,     ///< some cells failed, timed out or gave wrong hits
  interrupted = 130,  ///< and resumable
};

/// The command line: commands add themselves to `app`; the one that was called sets `action`. Nothing but main() touches the process's own streams,
/// arguments and environment.
struct Cli {
  Cli();
  CLI::App app{"", "raymeter"};
  std::ostream* out = nullptr;  ///< data
  std::ostream* err = nullptr;  ///< messages
  bool err_is_terminal = false;
  bool color = false;                                          ///< whether a terminal's colours may be used
  std::vector<std::string> arguments;                          ///< as called
  std::function<const char*(const std::string&)> environment;  ///< an environment variable's value or null
  std::function<ExitCode()> action;

  /// A subcommand whose help begins with an example.
  CLI::App& add_command(const std::string& name, const std::string& example, const std::string& description);
};

void add_run(Cli& cli);
void add_validate(Cli& cli);
void add_plan(Cli& cli);
void add_list(Cli& cli);
void add_describe(Cli& cli);
void add_schema(Cli& cli);
void add_env(Cli& cli);
void add_image(Cli& cli);
void add_trace(Cli& cli);
void add_report(Cli& cli);
void add_compare(Cli& cli);

}  // namespace raymeter
