#include "experiments/config/load_json.h"

#include <algorithm>
#include <charconv>
#include <set>

#include <fmt/format.h>

#include "core/base/error.h"
#include "experiments/in_quotes.h"

namespace raymeter {

namespace {

using Json = nlohmann::json;

std::size_t line_of(std::string_view text, std::size_t byte) {
  return 1 + static_cast<std::size_t>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(std::min(byte, text.size())), '\n'));
}

/// One step of a dotted path: into a member, or into a list's element.
Json& step(Json& json, std::string_view part, const std::string& setting) {
  const std::size_t bracket = part.find('[');
  Json* next = &json;
  if (bracket > 0) {
    if (!json.is_object() && !json.is_null()) throw Error(fmt::format("--set {}: {} is not in an object", setting, part));
    next = &json[std::string(part.substr(0, bracket))];
  }
  for (std::size_t at = bracket; at < part.size();) {
    std::size_t index = 0;
    const auto [end, error] = std::from_chars(part.data() + at + 1, part.data() + part.size(), index);
    if (error != std::errc{} || end == part.data() + part.size() || *end != ']') throw Error(fmt::format("--set {}: expected a number in brackets", setting));
    if (!next->is_array() || index >= next->size()) throw Error(fmt::format("--set {}: no element [{}]", setting, index));
    next = &(*next)[index];
    at = static_cast<std::size_t>(end - part.data()) + 1;
  }
  return *next;
}

/// Refuses what no config needs: levels and lengths that would exhaust the stack of what walks the document or matches a pattern, and texts that would break
/// a message's line.
void check_limits(int depth, Json::parse_event_t event, const Json& parsed) {
  constexpr int kMaxDepth = 32;
  constexpr std::size_t kMaxLength = 4096;
  if (depth > kMaxDepth) throw Error(fmt::format("nested deeper than {} levels", kMaxDepth));
  if ((event != Json::parse_event_t::key && event != Json::parse_event_t::value) || !parsed.is_string()) return;
  const std::string& text = parsed.get_ref<const std::string&>();
  if (text.size() > kMaxLength) throw Error(fmt::format("{} has more than {} bytes", in_quotes(text), kMaxLength));
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < ' '; };
  if (std::any_of(text.begin(), text.end(), is_control)) throw Error(fmt::format("{} has a control character", in_quotes(text)));
}

}  // namespace

Json load_json(std::string_view text) {
  std::vector<std::set<std::string>> keys;
  const auto check = [&](int depth, Json::parse_event_t event, Json& parsed) {
    check_limits(depth, event, parsed);
    if (event == Json::parse_event_t::object_start) keys.emplace_back();
    if (event == Json::parse_event_t::object_end) keys.pop_back();
    if (event == Json::parse_event_t::key && !keys.back().insert(parsed.get<std::string>()).second) {
      throw Error(fmt::format("key '{}' stands twice in one object", parsed.get<std::string>()));
    }
    return true;
  };
  try {
    return Json::parse(text, check, true, true);
  } catch (const Json::parse_error& error) {
    std::string_view what = error.what();
    const std::size_t detail = what.find(": ");
    what = detail == std::string_view::npos ? what : what.substr(detail + 2);
    throw Error(fmt::format("line {}: not JSON: {}", line_of(text, error.byte), what));
  } catch (const Json::out_of_range&) {
    throw Error("not JSON: a number is out of range");
  }
}

void apply_setting(Json& document, const std::string& setting) {
  const std::size_t equals = setting.find('=');
  if (equals == std::string::npos || equals == 0) throw Error(fmt::format("--set: expected KEY=VALUE, got '{}'", setting));
  Json* target = &document;
  std::string_view path = std::string_view(setting).substr(0, equals);
  while (!path.empty()) {
    const std::string_view part = path.substr(0, path.find('.'));
    path.remove_prefix(std::min(path.size(), part.size() + 1));
    target = &step(*target, part, setting);
  }
  const std::string text = setting.substr(equals + 1);
  const auto check = [](int depth, Json::parse_event_t event, Json& parsed) {
    check_limits(depth, event, parsed);
    return true;
  };
  Json value = Json::parse(text, check, false);
  *target = value.is_discarded() ? Json(text) : std::move(value);
}

}  // namespace raymeter
