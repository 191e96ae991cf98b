#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace raymeter {

/// 64-bit FNV-1a, as 16 hexadecimal digits: names cells and plans.
[[nodiscard]] std::string hash_text(std::string_view text);
[[nodiscard]] std::string hex_text(std::uint64_t value);

}  // namespace raymeter
