#include "accel/params.h"

#include <algorithm>
#include <charconv>
#include <numeric>

namespace raymeter {

namespace {

std::string number_text(double value) {
  char text[32];
  const auto [end, error] = std::to_chars(text, text + sizeof text, value);
  return error == std::errc{} ? std::string(text, end) : std::string("?");
}

std::string joined(std::span<const std::string_view> words) {
  std::string text;
  for (const std::string_view word : words) text += (text.empty() ? "" : ", ") + std::string(word);
  return text;
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({substituted, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

std::string expected(const ParamInfo& info) {
  if (std::holds_alternative<bool>(info.default_value)) return "true or false";
  if (std::holds_alternative<std::string>(info.default_value)) return info.choices.empty() ? "a text" : "one of " + joined(info.choices);
  const bool whole = std::holds_alternative<std::int64_t>(info.default_value);
  return std::string(whole ? "a whole number" : "a number") + " from " + number_range(info);
}

}  // namespace

std::string to_string(const ParamValue& value) {
  return std::visit(
      []<class T>(const T& v) -> std::string {
        if constexpr (std::is_same_v<T, bool>)
          return v ? "true" : "false";
        else if constexpr (std::is_same_v<T, std::int64_t>)
          return std::to_string(v);
        else if constexpr (std::is_same_v<T, double>)
          return number_text(v);
        else
          return v;
      },
      value);
}

std::string number_range(const ParamInfo& info) {
  std::string text = number_text(info.min) + " to " + number_text(info.max);
  for (const std::int64_t value : info.also) text += " or " + std::to_string(value);
  return text;
}

std::string nearest_word(std::string_view word, std::span<const std::string_view> known) {
  std::string_view best;
  std::size_t least = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string_view candidate : known) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < least) {
      least = distance;
      best = candidate;
    }
  }
  return std::string(best);
}

namespace params_detail {

void check_number(const ParamInfo& info, double value) {
  const bool beside = std::any_of(info.also.begin(), info.also.end(), [&](std::int64_t one) { return static_cast<double>(one) == value; });
  if (!(value >= info.min && value <= info.max) && !beside) throw Error(std::string(info.key) + ": expected " + expected(info) + ", got " + number_text(value));
}

void check_choice(const ParamInfo& info, std::string_view value) {
  if (info.choices.empty() || std::find(info.choices.begin(), info.choices.end(), value) != info.choices.end()) return;
  throw Error(std::string(info.key) + ": expected " + expected(info) + ", got '" + std::string(value) + "'");
}

void unknown_key(std::string_view key, std::span<const ParamInfo> infos) {
  std::vector<std::string_view> keys;
  for (const ParamInfo& info : infos) keys.push_back(info.key);
  const std::string near = nearest_word(key, keys);
  throw Error(std::string(key) + ": unknown parameter; " +
              (!near.empty()  ? "did you mean " + near + "?"
               : keys.empty() ? std::string("there are none")
                              : "there are " + joined(keys)));
}

void wrong_type(const ParamInfo& info, const ParamValue& value) {
  throw Error(std::string(info.key) + ": expected " + expected(info) + ", got '" + to_string(value) + "'");
}

}  // namespace params_detail

void check_used(std::span<const ParamInfo> infos, const std::string& key, const ParamValue& value, std::span<const ParamValues> settings) {
  const auto info = std::find_if(infos.begin(), infos.end(), [&](const ParamInfo& one) { return one.key == key; });
  if (info == infos.end() || to_string(value) == to_string(info->default_value)) return;
  const auto has = [&](const ParamValues& setting) {
    return std::any_of(setting.begin(), setting.end(), [&](const auto& entry) { return entry.first == key; });
  };
  if (std::any_of(settings.begin(), settings.end(), has)) return;
  throw Error(key + ": does nothing beside the other parameters, expected its default, " + to_string(info->default_value) + ", got " + to_string(value) + " (" +
              std::string(info->help) + ")");
}

}  // namespace raymeter
