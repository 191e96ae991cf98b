#include "experiments/scenes/source_file.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <memory>

#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>

namespace raymeter {

namespace {

/// A compressed file may hold thousands of times its size; no scene needs more than this.
constexpr std::size_t kMaxDecompressed = std::size_t{16} << 30;

std::string read_plain(const std::filesystem::path& path, const std::string& name) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw Error(fmt::format("{}: cannot be opened: {}", name, std::strerror(errno)));
  std::string bytes(std::filesystem::file_size(path), '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (static_cast<std::size_t>(stream.gcount()) != bytes.size()) throw Error(name + ": cannot be read to its end");
  return bytes;
}

std::string read_compressed(const std::filesystem::path& path, const std::string& name) {
  const std::unique_ptr<archive, int (*)(archive*)> stream(archive_read_new(), archive_read_free);
  if (!stream) throw std::bad_alloc();
  const auto check = [&](la_ssize_t result) {
    if (result >= ARCHIVE_OK) return;
    const char* const reason = archive_error_string(stream.get());
    throw Error(fmt::format("{}: cannot be decompressed: {}", name, reason ? reason : "unknown reason"));
  };
  check(archive_read_support_filter_xz(stream.get()));
  check(archive_read_support_filter_gzip(stream.get()));
  check(archive_read_support_format_raw(stream.get()));
  check(archive_read_open_filename(stream.get(), path.c_str(), std::size_t{1} << 16));
  archive_entry* entry = nullptr;
  const int first = archive_read_next_header(stream.get(), &entry);
  if (first == ARCHIVE_EOF) return {};
  check(first);
  // libarchive passes through what it does not recognise.
  if (archive_filter_count(stream.get()) < 2) throw Error(name + ": is not compressed as its name says; expected xz or gzip data");
  std::string bytes;
  const auto chunk = std::make_unique<std::array<char, std::size_t{1} << 18>>();
  for (;;) {
    const la_ssize_t size = archive_read_data(stream.get(), chunk->data(), chunk->size());
    check(size);
    if (size == 0) return bytes;
    bytes.append(chunk->data(), static_cast<std::size_t>(size));
    if (bytes.size() > kMaxDecompressed) throw Error(fmt::format("{}: decompresses to more than {} GiB", name, kMaxDecompressed >> 30));
  }
}

}  // namespace

Error SourceFile::error(std::string_view what) const { return Error(fmt::format("{}: {}", name, what)); }

SourceFile read_source_file(const std::string& path) {
  const std::filesystem::path file_path(path);
  std::error_code failure;
  const std::filesystem::file_status status = std::filesystem::status(file_path, failure);
  if (!std::filesystem::exists(status)) throw Error(path + ": no such file");
  if (!std::filesystem::is_regular_file(status)) throw Error(path + ": is not a regular file");
  const bool compressed = without_compression(path).size() < path.size();
  return {path, compressed ? read_compressed(file_path, path) : read_plain(file_path, path), file_path.parent_path()};
}

std::string_view without_compression(std::string_view name) noexcept {
  for (const std::string_view ending : {".xz", ".gz"}) {
    if (name.ends_with(ending)) return name.substr(0, name.size() - ending.size());
  }
  return name;
}

}  // namespace raymeter
