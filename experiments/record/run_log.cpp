#include "experiments/record/run_log.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include <fcntl.h>
#include <unistd.h>

#include <fmt/format.h>

#include "core/base/error.h"
#include "experiments/atomic_file.h"
#include "experiments/record/record_json.h"

namespace raymeter {

namespace {

constexpr std::chrono::seconds kSyncEvery{1};

/// Adds the whole lines of `text`; returns the bytes that they take. The last line may be torn, by a kill or a full disk.
std::size_t read_lines(const std::string& text, const std::string& path, RunRecords& records) {
  std::size_t at = 0;
  for (int number = 1; at < text.size(); ++number) {
    const std::size_t end = text.find('\n', at);
    if (end == std::string::npos) break;
    if (!add_record(text.substr(at, end - at), records)) {
      if (end + 1 == text.size()) break;
      throw Error(fmt::format("{}: line {}: not a record of a run; --fresh starts anew", path, number));
    }
    at = end + 1;
  }
  return at;
}

std::string file_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (file) text << file.rdbuf();
  if (!file || text.bad()) throw Error(path.string() + ": cannot be read");
  return std::move(text).str();
}

}  // namespace

RunLog::RunLog(const std::filesystem::path& path) : path_(path.string()) {
  descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (descriptor_ < 0) throw Error(fmt::format("{}: cannot be written: {}", path_, std::strerror(errno)));
  try {
    size_ = static_cast<std::int64_t>(read_lines(file_text(path), path_, records_));
    if (::ftruncate(descriptor_, size_) != 0) throw std::runtime_error(fmt::format("{}: {}", path_, std::strerror(errno)));
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
}

RunLog::~RunLog() {
  ::fsync(descriptor_);
  ::close(descriptor_);
}

void RunLog::append(const std::string& line) {
  try {
    write_fully(descriptor_, line.data(), line.size(), path_);
  } catch (...) {
    (void)!::ftruncate(descriptor_, size_);  // cut off what was written of the line; should that fail too, the next reader does it
    throw;
  }
  size_ += static_cast<std::int64_t>(line.size());
  if (std::chrono::steady_clock::now() - synced_ >= kSyncEvery) sync();
}

void RunLog::sync() {
  if (::fsync(descriptor_) != 0) throw std::runtime_error(fmt::format("{}: write failed: {}", path_, std::strerror(errno)));
  synced_ = std::chrono::steady_clock::now();
}

std::string RunLog::line(const SceneRecord& record) { return to_json(record).dump() + "\n"; }
std::string RunLog::line(const BuildRecord& record) { return to_json(record).dump() + "\n"; }
std::string RunLog::line(const CheckRecord& record) { return to_json(record).dump() + "\n"; }
std::string RunLog::line(const SampleRecord& record) { return to_json(record).dump() + "\n"; }
std::string RunLog::line(const EndRecord& record) { return to_json(record).dump() + "\n"; }

RunRecords read_run_log(const std::filesystem::path& path) {
  RunRecords records;
  read_lines(file_text(path), path.string(), records);
  return records;
}

}  // namespace raymeter
