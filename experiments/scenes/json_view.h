#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "experiments/scenes/source_file.h"

namespace raymeter {

/// A value within a file's JSON that knows its path, so that what is wrong with it can be said. Access to what is not there or of another type throws Error.
class JsonView {
public:
  JsonView(const SourceFile& file, const nlohmann::json& root) noexcept : JsonView(file, root, {}) {}

  /// A member that must exist, or may.
  [[nodiscard]] JsonView at(std::string_view key) const;
  [[nodiscard]] std::optional<JsonView> find(std::string_view key) const;
  /// An element of an array.
  [[nodiscard]] JsonView at(std::int64_t index) const;
  [[nodiscard]] std::int64_t size() const;

  [[nodiscard]] double number() const;
  [[nodiscard]] std::int64_t integer(std::int64_t min, std::int64_t max) const;
  [[nodiscard]] std::string_view text() const;
  /// Member `key` as an integer, `otherwise` where it is absent.
  [[nodiscard]] std::int64_t integer_or(std::string_view key, std::int64_t otherwise, std::int64_t min, std::int64_t max) const;

  /// "NAME: PATH: what".
  [[nodiscard]] Error error(std::string_view what) const;

private:
  JsonView(const SourceFile& file, const nlohmann::json& value, std::string path) noexcept : file_(&file), value_(&value), path_(std::move(path)) {}

  const SourceFile* file_;
  const nlohmann::json* value_;
  std::string path_;
};

}  // namespace raymeter
