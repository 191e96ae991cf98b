#include "experiments/config/hash.h"

#include <fmt/format.h>

namespace raymeter {

std::string hash_text(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return hex_text(hash);
}

std::string hex_text(std::uint64_t value) { return fmt::format("{:016x}", value); }

}  // namespace raymeter
