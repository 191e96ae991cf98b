#include "experiments/scenes/text_reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

#include "experiments/in_quotes.h"

namespace raymeter {

namespace {

bool is_blank(char c) noexcept { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }
bool is_space(char c) noexcept { return is_blank(c) || c == '\n'; }

/// Without a leading plus, which from_chars refuses.
std::string_view unsigned_plus(std::string_view token) noexcept {
  return token.size() > 1 && token[0] == '+' && token[1] != '-' && token[1] != '+' ? token.substr(1) : token;
}

}  // namespace

std::optional<double> parse_number(std::string_view token) {
  const std::string_view digits = unsigned_plus(token);
  double value = 0;
  const auto [end, failure] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (end != digits.data() + digits.size() || failure == std::errc::invalid_argument) return std::nullopt;
  // from_chars does not tell too large from too small.
  if (failure == std::errc::result_out_of_range) return std::strtod(std::string(digits).c_str(), nullptr);
  return value;
}

TextReader::TextReader(const SourceFile& file, char comment, std::size_t offset, int first_line) noexcept
    : file_(file), text_(file.bytes), position_(offset), comment_(comment), line_(first_line), token_line_(first_line) {}

void TextReader::skip_blanks() noexcept {
  while (position_ < text_.size()) {
    const char c = text_[position_];
    if (is_blank(c)) {
      ++position_;
    } else if (c == '\\' && (text_.substr(position_ + 1).starts_with('\n') || text_.substr(position_ + 1).starts_with("\r\n"))) {
      position_ = text_.find('\n', position_) + 1;
      ++line_;
    } else if (c == comment_ && comment_ != '\0') {
      position_ = std::min(text_.find('\n', position_), text_.size());
    } else {
      return;
    }
  }
}

bool TextReader::at_line_end() noexcept {
  skip_blanks();
  return position_ == text_.size() || text_[position_] == '\n';
}

std::size_t TextReader::token_end() const noexcept {
  std::size_t end = position_;
  while (end < text_.size() && !is_space(text_[end])) ++end;
  return end;
}

std::string_view TextReader::peek() noexcept {
  while (at_line_end() && position_ < text_.size()) {
    ++position_;
    ++line_;
  }
  return text_.substr(position_, token_end() - position_);
}

std::string_view TextReader::next(std::string_view expected) {
  const std::string_view token = peek();
  token_line_ = line_;
  if (token.empty()) throw error(fmt::format("the file ends; expected {}", expected));
  position_ += token.size();
  return token;
}

double TextReader::number(std::string_view expected) {
  const std::string_view token = next(expected);
  const std::optional<double> value = parse_number(token);
  if (!value) throw error(fmt::format("{} is not a number; expected {}", in_quotes(token), expected));
  return *value;
}

double TextReader::finite_number(std::string_view expected) {
  const double value = number(expected);
  if (!std::isfinite(value)) throw error(fmt::format("{} must be finite", expected));
  return value;
}

std::int64_t TextReader::integer(std::string_view expected, std::int64_t min, std::int64_t max) {
  const std::string_view token = next(expected);
  const std::string_view digits = unsigned_plus(token);
  std::int64_t value = 0;
  const auto [end, failure] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (failure != std::errc() || end != digits.data() + digits.size() || value < min || value > max) {
    throw error(fmt::format("{} is not allowed; expected {}, an integer from {} to {}", in_quotes(token), expected, min, max));
  }
  return value;
}

void TextReader::keyword(std::string_view word) {
  const std::string_view token = next(in_quotes(word));
  if (token != word) throw error(fmt::format("unknown {}; expected {}", in_quotes(token), in_quotes(word)));
}

std::string_view TextReader::rest_of_line() noexcept {
  skip_blanks();
  std::size_t end = std::min(text_.find('\n', position_), text_.size());
  std::string_view rest = text_.substr(position_, end - position_);
  position_ = end;
  while (!rest.empty() && is_blank(rest.back())) rest.remove_suffix(1);
  return rest;
}

Error TextReader::error(std::string_view what) const { return Error(fmt::format("{}:{}: {}", file_.name, token_line_, what)); }

}  // namespace raymeter
