#include <algorithm>
#include <memory>
#include <ostream>

#include <fmt/format.h>

#include "experiments/cli/cli.h"
#include "experiments/record/compare.h"

namespace raymeter {

namespace {

struct Options {
  std::string base, with;
  double margin = 0.05;
  bool strict = false;
};

enum class Verdict { slower, faster, same, inconclusive };

Verdict verdict_of(const Interval& interval, double margin) {
  if (interval.lo > 1 + margin) return Verdict::slower;
  if (interval.hi < 1 / (1 + margin)) return Verdict::faster;
  return interval.lo >= 1 / (1 + margin) && interval.hi <= 1 + margin ? Verdict::same : Verdict::inconclusive;
}

std::string line_of(const CellComparison& cell, double margin) {
  constexpr const char* words[]{"slower", "faster", "same", "inconclusive"};
  std::string line = cell.interval ? fmt::format("{:7.3f} [{:6.3f}, {:6.3f}] {:<12}", *cell.ratio, cell.interval->lo, cell.interval->hi,
                                                 words[static_cast<int>(verdict_of(*cell.interval, margin))])
                     : cell.ratio  ? fmt::format("{:7.3f} {:<29}", *cell.ratio, "too few passes")
                                   : fmt::format("{:<37}", "      - not timed");
  line += "  " + cell.what + '\n';
  for (const std::string& change : cell.changed) line += "        changed: " + change + '\n';
  return line;
}

ExitCode compare(const Cli& cli, const Options& options) {
  const RunComparison runs = compare_runs(options.base, options.with);
  *cli.out << "  ratio [95 % interval  ] verdict       cell   (time of NEW / time of BASE; below 1 is faster)\n";
  bool changed = false, slower = false, open = false;
  for (const CellComparison& cell : runs.cells) {
    *cli.out << line_of(cell, options.margin);
    changed |= !cell.changed.empty();
    if (!cell.ratio || !runs.same_machine) continue;
    const Verdict verdict = cell.interval ? verdict_of(*cell.interval, options.margin) : Verdict::inconclusive;
    slower |= verdict == Verdict::slower;
    open |= verdict == Verdict::inconclusive;
  }
  if (runs.geomean) *cli.out << fmt::format("{:7.3f} geometric mean of {} cells\n", *runs.geomean, runs.cells.size());
  if (runs.only_base + runs.only_new > 0) *cli.err << fmt::format("note: {} cells only in BASE, {} only in NEW\n", runs.only_base, runs.only_new);
  if (runs.cells.empty()) *cli.err << "note: the runs have no cell in common\n";
  if (!runs.same_machine) *cli.err << "note: the runs come from different machines: their times are not judged\n";
  if (changed) return ExitCode::changed;
  if (slower) return ExitCode::slower;
  return options.strict && (open || runs.cells.empty()) ? ExitCode::inconclusive : ExitCode::success;
}

}  // namespace

void add_compare(Cli& cli) {
  auto options = std::make_shared<Options>();
  CLI::App& command = cli.add_command("compare", "raymeter compare results/quick/OLD results/quick/NEW",
                                      "Compares two runs cell by cell: exit code 4 where counters or hits differ, 3 where a cell is slower beyond the margin.");
  command.add_option("base", options->base, "Results folder")->required();
  command.add_option("new", options->with, "Results folder")->required();
  command.add_option("--margin", options->margin, "Differences within this share are none")->check(CLI::Range(0.0, 10.0))->capture_default_str();
  command.add_flag("--strict", options->strict, "Exit code 5 where a cell's interval is too wide to tell, or nothing can be compared");
  command.callback([&cli, options] { cli.action = [&cli, options] { return compare(cli, *options); }; });
}

}  // namespace raymeter
