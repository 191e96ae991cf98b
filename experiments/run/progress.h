#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <string>

namespace raymeter {

enum class ProgressStyle : unsigned char { terminal, plain, json, none };

/// Tells how far a run is and about how long it will take still: one line that is rewritten, a line every few seconds, or JSON lines.
class Progress {
public:
  Progress(std::ostream& out, ProgressStyle style) : out_(out), style_(style) {}

  /// The work of the whole run and how much an earlier one has done, in passes.
  void begin(std::int64_t passes, std::int64_t done);
  /// Says what comes now, in which scene; `cells` done of all.
  void step(const std::string& scene, const std::string& what, std::size_t cells_done, std::size_t cells);
  /// Passes that are done or will not be needed.
  void add(std::int64_t passes);
  /// Ends the line that is rewritten.
  void end();

private:
  void show(bool now);
  [[nodiscard]] double seconds_left() const;

  std::ostream& out_;
  ProgressStyle style_;
  std::string scene_, what_;
  std::size_t cells_done_ = 0, cells_ = 0;
  std::int64_t passes_ = 0, done_ = 0, done_before_ = 0;
  std::chrono::steady_clock::time_point start_, shown_;
  bool line_open_ = false;
};

}  // namespace raymeter
