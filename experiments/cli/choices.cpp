#include "experiments/cli/choices.h"

#include <charconv>

#include "core/base/error.h"

namespace raymeter {

Isa chosen_isa(const std::string& text) {
  if (text.empty()) return best_isa();
  const std::optional<Isa> isa = isa_from_name(text);
  if (!isa) throw Error("--isa: unknown instruction set '" + text + "', expected scalar, sse42, avx2 or avx512");
  if (!available(*isa)) throw Error("--isa: this machine has no " + text);
  return *isa;
}

int chosen_threads(const std::string& text) {
  if (text == "all") return 0;
  int threads = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), threads);
  if (error != std::errc{} || end != text.data() + text.size() || threads < 1 || threads > 4096) {
    throw Error("--threads: expected a whole number from 1 to 4096 or all, got '" + text + "'");
  }
  return threads;
}

}  // namespace raymeter
