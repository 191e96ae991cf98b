#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "core/base/error.h"

namespace raymeter {

/// A parameter's value as the user wrote it or as it was resolved.
using ParamValue = std::variant<bool, std::int64_t, double, std::string>;
using ParamValues = std::vector<std::pair<std::string, ParamValue>>;

[[nodiscard]] std::string to_string(const ParamValue& value);

/// Whether changing a parameter needs a new build, or only another query on the same one.
enum class ParamUse : std::uint8_t { build, query };

/// What is known of a parameter without its struct: for `describe`, the schema and messages.
struct ParamInfo {
  std::string_view key;
  std::string_view help;
  ParamValue default_value;
  double min = 0;  ///< numbers only, as are max and also
  double max = 0;
  std::vector<std::string_view> choices;  ///< strings only; empty: any text
  ParamUse use = ParamUse::build;
  std::vector<std::vector<std::string_view>> same_build;  ///< groups of choices that share a build; of a query the others have builds of their own
  std::vector<std::int64_t> also;                         ///< whole numbers only: those allowed besides min to max
};

/// One row of a technique's static fields(): where the value lives and what is allowed. Default values stand in the struct alone.
template <class Params>
struct Param {
  std::string_view key;
  std::variant<bool Params::*, int Params::*, double Params::*, std::string Params::*> member;
  std::string_view help;
  double min = 0;
  double max = 0;
  std::vector<std::string_view> choices = {};
  ParamUse use = ParamUse::build;
  /// Whether it means anything beside the others; null: always.
  bool (*applies)(const Params&) = nullptr;
  std::vector<std::vector<std::string_view>> same_build = {};
  std::vector<std::int64_t> also = {};
};

/// The same row, for settings alone in which the parameter means something.
template <class Params>
[[nodiscard]] Param<Params> where(bool (*applies)(const std::type_identity_t<Params>&), Param<Params> row) {
  row.applies = applies;
  return row;
}

/// The numbers that a parameter may be: "2 to 16 or 32".
[[nodiscard]] std::string number_range(const ParamInfo& info);

/// The known word nearest to `word`, for "did you mean"; empty where none is near.
[[nodiscard]] std::string nearest_word(std::string_view word, std::span<const std::string_view> known);

namespace params_detail {
void check_number(const ParamInfo& info, double value);
void check_choice(const ParamInfo& info, std::string_view value);
[[noreturn]] void unknown_key(std::string_view key, std::span<const ParamInfo> infos);
[[noreturn]] void wrong_type(const ParamInfo& info, const ParamValue& value);
}  // namespace params_detail

/// Throws Error for a value other than the default whose parameter is in none of `settings`, resolved ones that came of it: it would do nothing.
void check_used(std::span<const ParamInfo> infos, const std::string& key, const ParamValue& value, std::span<const ParamValues> settings);

/// The parameters of a technique, with defaults.
template <class Params>
[[nodiscard]] std::vector<ParamInfo> param_infos() {
  const Params defaults;
  std::vector<ParamInfo> infos;
  for (const auto& field : Params::fields()) {
    ParamInfo info{field.key, field.help, {}, field.min, field.max, field.choices, field.use, field.same_build, field.also};
    std::visit(
        [&]<class T>(T Params::*member) {
          if constexpr (std::is_same_v<T, int>)
            info.default_value = std::int64_t{defaults.*member};
          else
            info.default_value = defaults.*member;
        },
        field.member);
    infos.push_back(std::move(info));
  }
  return infos;
}

/// Fills a technique's parameters; throws Error on an unknown key, a wrong type or a value out of range. The message begins with the key.
template <class Params>
[[nodiscard]] Params bind(const ParamValues& values) {
  Params params;
  const std::vector<ParamInfo> infos = param_infos<Params>();
  const auto fields = Params::fields();
  for (const auto& entry : values) {
    const std::string& key = entry.first;
    const ParamValue& value = entry.second;  // clang 14 captures no structured bindings
    std::size_t i = 0;
    while (i < infos.size() && infos[i].key != key) ++i;
    if (i == infos.size()) params_detail::unknown_key(key, infos);
    std::visit(
        [&]<class T>(T Params::*member) {
          if constexpr (std::is_same_v<T, double>) {
            if (const auto* whole = std::get_if<std::int64_t>(&value))
              params.*member = static_cast<double>(*whole);
            else if (const auto* number = std::get_if<double>(&value))
              params.*member = *number;
            else
              params_detail::wrong_type(infos[i], value);
            params_detail::check_number(infos[i], params.*member);
          } else if constexpr (std::is_same_v<T, int>) {
            const auto* whole = std::get_if<std::int64_t>(&value);
            if (whole == nullptr) params_detail::wrong_type(infos[i], value);
            params_detail::check_number(infos[i], static_cast<double>(*whole));
            params.*member = static_cast<int>(*whole);
          } else {
            const auto* exact = std::get_if<T>(&value);
            if (exact == nullptr) params_detail::wrong_type(infos[i], value);
            if constexpr (std::is_same_v<T, std::string>) params_detail::check_choice(infos[i], *exact);
            params.*member = *exact;
          }
        },
        fields[i].member);
  }
  return params;
}

/// The parameters that mean something beside each other, with their values, defaults included, in the order of fields(): what records show. bind() makes the
/// same setting of them, so that two settings that differ only in what does nothing are one.
template <class Params>
[[nodiscard]] ParamValues resolved(const Params& params) {
  ParamValues values;
  for (const auto& field : Params::fields()) {
    if (field.applies != nullptr && !field.applies(params)) continue;
    std::visit(
        [&]<class T>(T Params::*member) {
          if constexpr (std::is_same_v<T, int>)
            values.emplace_back(field.key, std::int64_t{params.*member});
          else
            values.emplace_back(field.key, params.*member);
        },
        field.member);
  }
  return values;
}

}  // namespace raymeter
