#pragma once

#include <memory>
#include <string>

namespace raymeter {

/// Where threads run. `auto`: passes on one thread stay on one core, others go where the system puts them; `none`; or a list of hardware threads, "0,2-3", that
/// the whole process keeps to.
class Pinning {
public:
  /// Throws Error for what is no such text, or where the machine has no such hardware thread.
  explicit Pinning(const std::string& text);
  ~Pinning();
  Pinning(const Pinning&) = delete;
  Pinning& operator=(const Pinning&) = delete;

  /// Before a timed pass on that many threads (0: all).
  void enter(int threads);
  /// After it.
  void leave();

private:
  struct Machine;
  std::unique_ptr<Machine> machine_;
  bool automatic_ = false;
  bool bound_ = false;
};

}  // namespace raymeter
