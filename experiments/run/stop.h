#pragma once

#include <chrono>

namespace raymeter {

enum class StopReason : unsigned char { none, interrupted, out_of_time };

/// When a run has to end early: SIGINT or SIGTERM came, or its time is up. A second signal kills at once.
class Stop {
public:
  /// Takes over both signals until destroyed. There may be one at a time.
  explicit Stop(double max_time_s);
  ~Stop();
  Stop(const Stop&) = delete;
  Stop& operator=(const Stop&) = delete;

  [[nodiscard]] StopReason reason() const noexcept;
  [[nodiscard]] bool requested() const noexcept { return reason() != StopReason::none; }

private:
  std::chrono::steady_clock::time_point deadline_;
};

}  // namespace raymeter
