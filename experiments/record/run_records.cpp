#include "experiments/record/run_records.h"

#include <algorithm>
#include <array>

namespace raymeter {

std::string_view name(Status status) noexcept {
  constexpr std::array<std::string_view, 7> names{"ok", "wrong", "skipped", "timeout", "failed", "refused", "unfinished"};
  return names[static_cast<std::size_t>(status)];
}

Status RunRecords::status(const std::string& cell, int wanted) const {
  if (const auto end = ends.find(cell); end != ends.end()) return end->second.status;
  const auto check = checks.find(cell);
  if (check == checks.end()) return Status::unfinished;
  if (check->second.status != Status::ok) return check->second.status;
  return samples_of(cell) >= wanted ? Status::ok : Status::unfinished;
}

std::string RunRecords::reason(const std::string& cell) const {
  if (const auto end = ends.find(cell); end != ends.end()) return end->second.reason;
  const auto check = checks.find(cell);
  return check == checks.end() ? std::string() : check->second.reason;
}

int RunRecords::samples_of(const std::string& cell) const {
  const auto found = samples.find(cell);
  return found == samples.end() ? 0 : static_cast<int>(found->second.size());
}

void RunRecords::add(const BuildRecord& record) {
  const auto [found, added] = builds.try_emplace({record.scene, record.build, record.threads}, record);
  if (!added) found->second.build_ms.insert(found->second.build_ms.end(), record.build_ms.begin(), record.build_ms.end());
}

void RunRecords::add(const SampleRecord& record) {
  samples[record.cell][record.sample] = record;
  sample_count = std::max(sample_count, record.order_index + 1);
}

}  // namespace raymeter
