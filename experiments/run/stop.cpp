#include "experiments/run/stop.h"

#include <algorithm>
#include <csignal>

namespace raymeter {

namespace {

// A signal handler can reach nothing but what is static.
volatile std::sig_atomic_t signal_came = 0;

extern "C" void note_signal(int) { signal_came = 1; }

}  // namespace

Stop::Stop(double max_time_s)
    : deadline_(std::chrono::steady_clock::now() +
                std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(std::min(max_time_s, 1e9)))) {
  signal_came = 0;
  struct sigaction action {};
  action.sa_handler = note_signal;
  action.sa_flags = static_cast<int>(SA_RESETHAND) | SA_RESTART;
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
}

Stop::~Stop() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

StopReason Stop::reason() const noexcept {
  if (signal_came != 0) return StopReason::interrupted;
  return std::chrono::steady_clock::now() >= deadline_ ? StopReason::out_of_time : StopReason::none;
}

}  // namespace raymeter
