#pragma once

#include <span>
#include <string>
#include <string_view>

namespace raymeter {

/// A parser as its fuzzer and the replay of its corpus see it.
struct FuzzedParser {
  std::string_view name;  ///< also of its corpus' folder
  /// Parses, and looks at all that came out. What a damaged file may cause is an Error, which is caught; anything else is a defect.
  void (*parse)(std::string_view bytes);
};

[[nodiscard]] std::span<const FuzzedParser> fuzzed_parsers() noexcept;

/// The fuzzers' common body.
int fuzz(std::string_view parser, std::string_view bytes);

}  // namespace raymeter
