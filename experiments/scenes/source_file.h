#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/error.h"

namespace raymeter {

/// A file in memory, decompressed.
struct SourceFile {
  std::string name;  ///< as the user wrote it, for messages
  std::string bytes;
  /// Where files that it refers to are looked up; without it no other file is read.
  std::optional<std::filesystem::path> folder;

  /// "NAME: what".
  [[nodiscard]] Error error(std::string_view what) const;
};

/// Reads a file, through a decompressor where its name ends in .xz or .gz. Throws Error where it cannot be opened, is no regular file or is damaged.
[[nodiscard]] SourceFile read_source_file(const std::string& path);

/// `name` without an ending .xz or .gz.
[[nodiscard]] std::string_view without_compression(std::string_view name) noexcept;

}  // namespace raymeter
