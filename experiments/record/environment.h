#pragma once

#include <string>
#include <vector>

namespace raymeter {

/// What of machine and build must agree before times may be compared.
struct Fingerprint {
  std::string host;
  std::string cpu;
  std::string git_sha;
  bool git_dirty = false;
  bool release = false;  ///< an optimised build
};
[[nodiscard]] Fingerprint fingerprint();

/// CPU, caches, memory, frequency control, kernel, load, compiler, flags and commit, as a JSON object. What cannot be known is null.
[[nodiscard]] std::string environment_json();
/// The same for people, one line each.
[[nodiscard]] std::string environment_text();
/// What makes times of this machine or build unsteady or not comparable, one sentence each.
[[nodiscard]] std::vector<std::string> noise_sources();

/// "20261122T173100Z".
[[nodiscard]] std::string utc_stamp();

}  // namespace raymeter
