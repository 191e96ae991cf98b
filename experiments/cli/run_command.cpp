#include <memory>
#include <ostream>

#include <fmt/format.h>

#include "experiments/cli/config_options.h"
#include "experiments/run/runner.h"

namespace raymeter {

namespace {

struct Options {
  ConfigOptions config;
  RunOptions run;
  bool dry_run = false;
  std::string progress = "auto";
};

ProgressStyle progress_style(const Cli& cli, const std::string& text) {
  if (text == "json") return ProgressStyle::json;
  if (text == "none") return ProgressStyle::none;
  return text == "auto" && cli.err_is_terminal ? ProgressStyle::terminal : ProgressStyle::plain;
}

/// An argument as a shell would need it.
std::string shell_quoted(const std::string& word) {
  if (!word.empty() && word.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=:,./@%") == std::string::npos) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string command_line(const std::vector<std::string>& arguments) {
  std::string text;
  for (const std::string& argument : arguments) text += (text.empty() ? "" : " ") + shell_quoted(argument);
  return text;
}

/// The command that continues this run.
std::string resume_command(const Cli& cli, const Options& options, const std::filesystem::path& folder) {
  std::vector<std::string> words{cli.arguments.front(), "run", options.config.path, "--out", folder.string(), "--resume"};
  for (const std::string& setting : options.config.settings) words.insert(words.end(), {"--set", setting});
  if (!options.config.filter.empty()) words.insert(words.end(), {"--filter", options.config.filter});
  if (!options.config.shard.empty()) words.insert(words.end(), {"--shard", options.config.shard});
  return command_line(words);
}

std::string count_text(const RunResult& result) {
  std::string text;
  for (const auto& [status, count] : result.cells) {
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, name(status));
  }
  return text;
}

ExitCode exit_code(const RunResult& result) {
  if (result.stopped == StopReason::interrupted) return ExitCode::interrupted;
  bool refused = false;
  for (const auto& [status, count] : result.cells) {
    if (count > 0 && status != Status::ok && status != Status::skipped && status != Status::refused) return ExitCode::incomplete;
    refused = refused || (count > 0 && status == Status::refused);
  }
  return refused ? ExitCode::usage : ExitCode::success;
}

ExitCode run(const Cli& cli, Options& options) {
  const Config config = options.config.load(cli);
  const std::vector<Experiment> cells = options.config.cells(config);
  if (options.dry_run) {
    *cli.out << plan_table(config, cells);
    return ExitCode::success;
  }
  options.run.command = command_line(cli.arguments);
  Progress progress(*cli.err, progress_style(cli, options.progress));
  const RunResult result = run_experiment(config, cells, options.run, progress);
  if (result.unfinished_run)
    *cli.err << fmt::format("note: an unfinished run of this config is in {}; --resume would have continued it\n", result.unfinished_run->string());
  for (const std::string& complaint : result.complaints) *cli.err << complaint << '\n';
  *cli.err << fmt::format("{}{} cells: {}\n", result.nothing_to_do ? "nothing to do; " : "", cells.size(), count_text(result));
  if (result.stopped != StopReason::none) {
    *cli.err << (result.stopped == StopReason::interrupted ? "interrupted" : "measure.max_time_s is over") << "; to continue:\n  "
             << resume_command(cli, options, result.folder) << '\n';
  }
  *cli.out << result.folder.string() << '\n';
  return exit_code(result);
}

}  // namespace

void add_run(Cli& cli) {
  auto options = std::make_shared<Options>();
  CLI::App& command =
      cli.add_command("run", "raymeter run configs/quick.json", "Measures every cell of a config: build, verify, count, time. Prints the results folder.");
  options->config.add_to(command);
  command.add_option("--out", options->run.out, "Results folder; default: results/NAME/UTC_COMMIT_HOST")->type_name("DIR");
  CLI::Option* const resume = command.add_flag("--resume", options->run.resume, "Continue the newest run of this config, or the one in --out");
  command.add_flag("--fresh", options->run.fresh, "Start anew, even in a folder that holds a run")->excludes(resume);
  command.add_flag("--dry-run", options->dry_run, "Print the cells and stop");
  command.add_option("--progress", options->progress, "auto, plain, json or none")
      ->check(CLI::IsMember({"auto", "plain", "json", "none"}))
      ->capture_default_str();
  command.add_option("--pin", options->run.pin, "auto: single-threaded passes stay on one core; none; or hardware threads such as 0,2-3")
      ->type_name("auto|none|LIST")
      ->capture_default_str();
  command.callback([&cli, options] { cli.action = [&cli, options] { return run(cli, *options); }; });
}

}  // namespace raymeter
