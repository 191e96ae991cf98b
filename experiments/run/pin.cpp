#include "experiments/run/pin.h"

#include <charconv>

#include <hwloc.h>

#include "core/base/error.h"

namespace raymeter {

struct Pinning::Machine {
  hwloc_topology_t topology = nullptr;
  hwloc_cpuset_t before = hwloc_bitmap_alloc();  ///< what the thread was bound to
  hwloc_cpuset_t core = nullptr;                 ///< one hardware thread of the last core that the process may use

  Machine() {
    hwloc_topology_init(&topology);
    hwloc_topology_load(topology);
    hwloc_get_cpubind(topology, before, HWLOC_CPUBIND_THREAD);
    // Interrupts and daemons tend to sit on the first cores.
    const int last = hwloc_bitmap_last(before);
    core = hwloc_bitmap_alloc();
    if (last >= 0) hwloc_bitmap_only(core, static_cast<unsigned>(last));
  }
  ~Machine() {
    hwloc_bitmap_free(before);
    hwloc_bitmap_free(core);
    hwloc_topology_destroy(topology);
  }
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;
};

namespace {

[[noreturn]] void fail(const std::string& text, const std::string& why) {
  throw Error("--pin " + text + ": " + why + ", expected auto, none or a list of hardware threads such as 0,2-3");
}

/// Binds the whole process to the hardware threads that the list names.
void bind_process(hwloc_topology_t topology, const std::string& text) {
  const hwloc_cpuset_t set = hwloc_bitmap_alloc();
  const char* at = text.data();
  const char* const end = at + text.size();
  bool good = !text.empty();
  while (good && at != end) {
    int first = 0;
    auto [next, error] = std::from_chars(at, end, first);
    int last = first;
    good = error == std::errc{} && first >= 0;
    if (good && next != end && *next == '-') {
      const auto range = std::from_chars(next + 1, end, last);
      good = range.ec == std::errc{} && last >= first;
      next = range.ptr;
    }
    if (good) hwloc_bitmap_set_range(set, static_cast<unsigned>(first), last);
    if (good && next != end) good = *next++ == ',' && next != end;
    at = next;
  }
  const bool there = good && hwloc_bitmap_isincluded(set, hwloc_topology_get_allowed_cpuset(topology)) != 0;
  const bool bound = there && hwloc_set_cpubind(topology, set, HWLOC_CPUBIND_PROCESS) == 0;
  hwloc_bitmap_free(set);
  if (!good) fail(text, "not a list");
  if (!bound) fail(text, "this machine has no such hardware thread");
}

}  // namespace

Pinning::Pinning(const std::string& text) {
  if (text == "none") return;
  machine_ = std::make_unique<Machine>();
  automatic_ = text == "auto";
  if (!automatic_) bind_process(machine_->topology, text);
}

Pinning::~Pinning() = default;

void Pinning::enter(int threads) {
  if (automatic_ && threads == 1) bound_ = hwloc_set_cpubind(machine_->topology, machine_->core, HWLOC_CPUBIND_THREAD) == 0;
}

void Pinning::leave() {
  if (bound_) hwloc_set_cpubind(machine_->topology, machine_->before, HWLOC_CPUBIND_THREAD);
  bound_ = false;
}

}  // namespace raymeter
