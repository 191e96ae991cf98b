#pragma once

#include <string>
#include <string_view>

namespace raymeter {

/// A file's or user's text for messages, so that they stay one readable line: in quotes, shortened to 40 bytes, with unprintable bytes as \xNN.
[[nodiscard]] std::string in_quotes(std::string_view text);

}  // namespace raymeter
