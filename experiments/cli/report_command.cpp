#include <cstring>
#include <filesystem>
#include <memory>

#include <spawn.h>
#include <sys/wait.h>

#include "core/base/error.h"
#include "experiments/cli/cli.h"

namespace raymeter {

namespace {

namespace fs = std::filesystem;

/// scripts/report.py of the source tree that the executable was built in: in the nearest folder above it that has one.
fs::path find_script() {
  for (fs::path folder = fs::read_symlink("/proc/self/exe").parent_path(); folder.has_relative_path(); folder = folder.parent_path()) {
    const fs::path script = folder / "scripts" / "report.py";
    if (fs::exists(script)) return script;
  }
  throw std::runtime_error("scripts/report.py was not found above the executable");
}

ExitCode report(const std::vector<std::string>& folders) {
  for (const std::string& folder : folders) {
    if (!fs::exists(fs::path(folder) / "manifest.json")) throw Error(folder + ": no manifest.json, expected the results of a run");
  }
  std::vector<std::string> words{"/usr/bin/python3", find_script().string()};  // Debian's Python, which has matplotlib
  words.insert(words.end(), folders.begin(), folders.end());
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t child = 0;
  if (const int error = ::posix_spawn(&child, arguments[0], nullptr, nullptr, arguments.data(), environ); error != 0) {
    throw std::runtime_error(words[0] + ": " + std::strerror(error));
  }
  int status = 0;
  if (::waitpid(child, &status, 0) != child || !WIFEXITED(status)) return ExitCode::failure;
  return static_cast<ExitCode>(WEXITSTATUS(status));
}

}  // namespace

void add_report(Cli& cli) {
  auto folders = std::make_shared<std::vector<std::string>>();
  CLI::App& command = cli.add_command("report", "raymeter report results/quick/*",
                                      "Writes report.html, report.md and plots: of one run into its folder, of several into combined/ of the first.");
  command.add_option("folders", *folders, "Results folders")->required();
  command.callback([&cli, folders] { cli.action = [folders] { return report(*folders); }; });
}

}  // namespace raymeter
