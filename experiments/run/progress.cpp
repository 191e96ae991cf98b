#include "experiments/run/progress.h"

#include <algorithm>
#include <ostream>

#include <fmt/chrono.h>
#include <fmt/format.h>

namespace raymeter {

using std::chrono::steady_clock;

void Progress::begin(std::int64_t passes, std::int64_t done) {
  passes_ = std::max<std::int64_t>(passes, 1);
  done_ = done_before_ = done;
  start_ = steady_clock::now();
}

void Progress::step(const std::string& scene, const std::string& what, std::size_t cells_done, std::size_t cells) {
  const bool news = scene != scene_ || (style_ == ProgressStyle::json && what != what_);
  scene_ = scene;
  what_ = what;
  cells_done_ = cells_done;
  cells_ = cells;
  show(news);
}

void Progress::add(std::int64_t passes) {
  done_ = std::min(done_ + passes, passes_);
  show(false);
}

void Progress::end() {
  if (line_open_) out_ << "\r\x1b[K" << std::flush;
  line_open_ = false;
}

double Progress::seconds_left() const {
  const double elapsed = std::chrono::duration<double>(steady_clock::now() - start_).count();
  const auto done = static_cast<double>(done_ - done_before_);
  return done > 0 ? elapsed * static_cast<double>(passes_ - done_) / done : -1;
}

void Progress::show(bool news) {
  if (style_ == ProgressStyle::none) return;
  const auto now = steady_clock::now();
  const auto every = style_ == ProgressStyle::terminal ? std::chrono::milliseconds(100) : std::chrono::milliseconds(5000);
  if (now - shown_ < every && !(news && style_ != ProgressStyle::terminal)) return;
  shown_ = now;
  const int percent = static_cast<int>(100 * done_ / passes_);
  const double left = seconds_left();
  if (style_ == ProgressStyle::json) {
    // The texts are scene names and our own words; quotes and backslashes are all that needs care.
    std::string what;
    for (const char c : scene_ + ": " + what_) what += c == '"' || c == '\\' ? std::string{'\\', c} : std::string(1, c);
    out_ << fmt::format("{{\"what\":\"{}\",\"cells_done\":{},\"cells\":{},\"percent\":{},\"seconds_left\":{}}}\n", what, cells_done_, cells_, percent,
                        left < 0 ? "null" : fmt::format("{:.0f}", left));
  } else {
    const std::string eta = left < 0 ? std::string() : fmt::format(", {:%H:%M:%S} left", std::chrono::seconds(static_cast<std::int64_t>(left + 0.5)));
    const std::string line = fmt::format("{:3d} %  {}/{} cells{}  {}: {}", percent, cells_done_, cells_, eta, scene_, what_);
    if (style_ == ProgressStyle::terminal)
      out_ << "\r\x1b[K" << line.substr(0, 120);
    else
      out_ << line << '\n';
    line_open_ = style_ == ProgressStyle::terminal;
  }
  out_ << std::flush;
}

}  // namespace raymeter
