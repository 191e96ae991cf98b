#include "experiments/scenes/json_view.h"

#include <fmt/format.h>

namespace raymeter {

JsonView JsonView::at(std::string_view key) const {
  std::optional<JsonView> member = find(key);
  if (!member) throw error(fmt::format("'{}' is missing", key));
  return *std::move(member);
}

std::optional<JsonView> JsonView::find(std::string_view key) const {
  if (!value_->is_object()) throw error("expected an object");
  const auto member = value_->find(key);
  if (member == value_->end()) return std::nullopt;
  return JsonView(*file_, *member, fmt::format("{}{}{}", path_, path_.empty() ? "" : ".", key));
}

JsonView JsonView::at(std::int64_t index) const {
  if (index < 0 || index >= size()) throw error(fmt::format("has {} elements, none of index {}", size(), index));
  return {*file_, (*value_)[static_cast<std::size_t>(index)], fmt::format("{}[{}]", path_, index)};
}

std::int64_t JsonView::size() const {
  if (!value_->is_array()) throw error("expected an array");
  return static_cast<std::int64_t>(value_->size());
}

double JsonView::number() const {
  if (!value_->is_number()) throw error("expected a number");
  return value_->get<double>();
}

std::int64_t JsonView::integer(std::int64_t min, std::int64_t max) const {
  // Unsigned numbers beyond int64 would wrap; as double they are out of every range.
  const bool in_range = value_->is_number_integer() && value_->get<double>() >= static_cast<double>(min) && value_->get<double>() <= static_cast<double>(max);
  if (!in_range || value_->get<std::int64_t>() < min || value_->get<std::int64_t>() > max)
    throw error(fmt::format("expected an integer from {} to {}", min, max));
  return value_->get<std::int64_t>();
}

std::string_view JsonView::text() const {
  if (!value_->is_string()) throw error("expected a string");
  return value_->get_ref<const std::string&>();
}

std::int64_t JsonView::integer_or(std::string_view key, std::int64_t otherwise, std::int64_t min, std::int64_t max) const {
  const std::optional<JsonView> member = find(key);
  return member ? member->integer(min, max) : otherwise;
}

Error JsonView::error(std::string_view what) const { return file_->error(path_.empty() ? std::string(what) : fmt::format("{}: {}", path_, what)); }

}  // namespace raymeter
