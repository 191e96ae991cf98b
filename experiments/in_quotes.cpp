#include "experiments/in_quotes.h"

#include <fmt/format.h>

namespace raymeter {

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kShown = 40;
  std::string quoted = "'";
  for (const char c : text.substr(0, kShown)) {
    if (c >= ' ' && c <= '~')
      quoted += c;
    else
      quoted += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
  }
  return quoted + (text.size() > kShown ? "...'" : "'");
}

}  // namespace raymeter
