#include "experiments/atomic_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include <fcntl.h>
#include <unistd.h>

#include <fmt/format.h>

#include "core/base/error.h"

namespace raymeter {

namespace {

/// The file that a path names, through links; the path itself where that does not exist.
std::string resolved(const std::string& path) {
  std::error_code none;
  const std::filesystem::path target = std::filesystem::canonical(path, none);
  return none ? path : target.string();
}

}  // namespace

AtomicFile::AtomicFile(std::string path) : path_(std::move(path)), target_(resolved(path_)) {
  std::error_code none;
  const std::filesystem::file_status there = std::filesystem::status(path_, none);
  if (std::filesystem::is_directory(there)) throw Error(path_ + ": is a folder, expected the name of a file");
  if (!std::filesystem::exists(there) || std::filesystem::is_regular_file(there)) {
    temporary_ = fmt::format("{}.tmp{}", target_, ::getpid());
    descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  } else {
    descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CLOEXEC);
  }
  if (descriptor_ < 0) throw Error(fmt::format("{}: cannot be written: {}", path_, std::strerror(errno)));
}

AtomicFile::~AtomicFile() {
  if (descriptor_ < 0) return;
  ::close(descriptor_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void AtomicFile::write(const void* bytes, std::size_t size) { write_fully(descriptor_, bytes, size, path_); }

void AtomicFile::commit() {
  if (::fsync(descriptor_) != 0 && errno != EINVAL && errno != EROFS)
    throw std::runtime_error(fmt::format("{}: write failed: {}", path_, std::strerror(errno)));
  if (!temporary_.empty() && std::rename(temporary_.c_str(), target_.c_str()) != 0)
    throw Error(fmt::format("{}: cannot be written: {}", path_, std::strerror(errno)));
  ::close(descriptor_);
  descriptor_ = -1;
}

void write_fully(int descriptor, const void* bytes, std::size_t size, std::string_view name) {
  const char* next = static_cast<const char*>(bytes);
  while (size > 0) {
    const ssize_t written = ::write(descriptor, next, size);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw std::runtime_error(fmt::format("{}: write failed: {}", name, std::strerror(errno)));
    next += written;
    size -= static_cast<std::size_t>(written);
  }
}

}  // namespace raymeter
