#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "experiments/scenes/source_file.h"

namespace raymeter {

/// The number that a whole token spells, "nan" and "inf" included; too large is infinite, too small is 0.
[[nodiscard]] std::optional<double> parse_number(std::string_view token);

/// Walks a text token by token (separated by whitespace; a backslash at a line's end counts as whitespace) and knows the line for messages.
class TextReader {
public:
  /// Reads file.bytes from `offset`, which is on line `first_line`. From `comment` at the start of a token to the end of its line the text is skipped.
  explicit TextReader(const SourceFile& file, char comment = '\0', std::size_t offset = 0, int first_line = 1) noexcept;

  /// No token left.
  [[nodiscard]] bool at_end() noexcept { return peek().empty(); }
  /// No token left on the line.
  [[nodiscard]] bool at_line_end() noexcept;
  /// The next token, which stays; empty at the end.
  [[nodiscard]] std::string_view peek() noexcept;
  /// The next token; throws Error, naming what was expected, at the end.
  std::string_view next(std::string_view expected);
  double number(std::string_view expected);
  /// A number that is neither NaN nor infinite.
  double finite_number(std::string_view expected);
  std::int64_t integer(std::string_view expected, std::int64_t min, std::int64_t max);
  /// The next token must be this one.
  void keyword(std::string_view word);
  /// What is left of the line, without the spaces around it; the next token is on another line.
  std::string_view rest_of_line() noexcept;

  /// Bytes from the start of the file to behind the last token.
  [[nodiscard]] std::size_t offset() const noexcept { return position_; }
  /// Line of the last token, from 1.
  [[nodiscard]] int line() const noexcept { return token_line_; }
  /// "NAME:LINE: what", with the line of the last token.
  [[nodiscard]] Error error(std::string_view what) const;

private:
  void skip_blanks() noexcept;
  [[nodiscard]] std::size_t token_end() const noexcept;

  const SourceFile& file_;
  std::string_view text_;
  std::size_t position_;
  char comment_;
  int line_;
  int token_line_;
};

}  // namespace raymeter
