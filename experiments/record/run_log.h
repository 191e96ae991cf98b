#pragma once

#include <chrono>
#include <filesystem>
#include <string>

#include "experiments/record/run_records.h"

namespace raymeter {

/// samples.jsonl: append-only, one whole line a write, so that kill -9 loses at most the line being written.
class RunLog {
public:
  /// Opens or makes the file, reads what it holds and cuts off a torn last line. Throws Error where it cannot be written, or a line before
  /// the last is damaged.
  explicit RunLog(const std::filesystem::path& path);
  ~RunLog();
  RunLog(const RunLog&) = delete;
  RunLog& operator=(const RunLog&) = delete;

  [[nodiscard]] const RunRecords& records() const noexcept { return records_; }
  /// Appends a line; throws std::runtime_error, with the file as before, where the device refuses.
  template <class Record>
  void add(const Record& record) {
    append(line(record));
    records_.add(record);
  }
  /// Forces to the device what was added; append does so itself once a second.
  void sync();

private:
  static std::string line(const SceneRecord& record);
  static std::string line(const BuildRecord& record);
  static std::string line(const CheckRecord& record);
  static std::string line(const SampleRecord& record);
  static std::string line(const EndRecord& record);
  void append(const std::string& line);

  std::string path_;
  int descriptor_ = -1;
  std::int64_t size_ = 0;
  std::chrono::steady_clock::time_point synced_;
  RunRecords records_;
};

/// What a run's samples.jsonl holds, without changing it; a torn last line is passed over.
[[nodiscard]] RunRecords read_run_log(const std::filesystem::path& path);

}  // namespace raymeter
