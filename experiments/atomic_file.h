#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace raymeter {

/// A file that appears whole under its name or not at all: written beside it, synced and renamed by commit(). A name that is a symbolic link stays one. What is
/// there and no file, such as a pipe, is written to as it is.
class AtomicFile {
public:
  /// Throws Error where the folder cannot be written, or where the name is a folder's.
  explicit AtomicFile(std::string path);
  /// Removes what was not committed.
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Throws std::runtime_error where the device refuses, e.g. when it is full.
  void write(const void* bytes, std::size_t size);
  void write(std::string_view text) { write(text.data(), text.size()); }
  void commit();

private:
  std::string path_;
  std::string target_;     ///< what path_ names, through links
  std::string temporary_;  ///< empty where the target is written to as it is
  int descriptor_ = -1;
};

/// Writes all of it or throws std::runtime_error, "<name>: write failed: <why>".
void write_fully(int descriptor, const void* bytes, std::size_t size, std::string_view name);

}  // namespace raymeter
