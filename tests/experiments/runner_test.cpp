#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include <unistd.h>

#include "accel/registry.h"
#include "experiments/config/expand.h"
#include "experiments/record/run_log.h"
#include "experiments/run/pass.h"
#include "experiments/run/runner.h"

namespace raymeter {
namespace {

/// Loses the first hit of every slice: always, or only while it is timed.
class LyingIntersector final : public Intersector {
public:
  LyingIntersector(std::unique_ptr<Intersector> honest, bool only_timed) : honest_(std::move(honest)), only_timed_(only_timed) {}
  [[nodiscard]] std::size_t scratch_bytes() const noexcept override { return honest_->scratch_bytes(); }
  void closest_hit(const RayView& rays, const HitView& hits, Counters* counters, std::byte* scratch) const noexcept override {
    honest_->closest_hit(rays, hits, counters, scratch);
    if (only_timed_ && counters != nullptr) return;
    for (int i = 0; i < hits.count; ++i) {
      if (hits.prim[i] < 0) continue;
      hits.prim[i] = -1;
      hits.t[i] = std::numeric_limits<float>::infinity();
      return;
    }
  }
  void any_hit(const RayView& rays, std::int32_t* blocker, Counters* counters, std::byte* scratch) const noexcept override {
    honest_->any_hit(rays, blocker, counters, scratch);
  }

private:
  std::unique_ptr<Intersector> honest_;
  bool only_timed_;
};

template <bool kOnlyTimed>
class LyingStructure final : public Structure {
public:
  explicit LyingStructure(const Scene& scene) : list_(structure_entry("list").build(scene, {}, 1)) {}
  [[nodiscard]] const BuildStats& stats() const noexcept override { return list_->stats(); }
  [[nodiscard]] std::unique_ptr<Intersector> intersector(const QueryOptions& options) const override {
    return std::make_unique<LyingIntersector>(list_->intersector(options), kOnlyTimed);
  }

private:
  std::unique_ptr<Structure> list_;
};

template <bool kOnlyTimed>
StructureEntry lying_entry(std::string_view name) {
  const StructureEntry& list = structure_entry("list");
  return {name,
          "loses hits",
          "nobody",
          list.params,
          list.resolve,
          [](const Scene& scene, const ParamValues&, int) -> std::unique_ptr<Structure> {
            return std::make_unique<LyingStructure<kOnlyTimed>>(scene); }};
}

class Runner : public testing::Test {
protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("raymeter_runner_test_" + std::to_string(::getpid()));
    std::filesystem::remove_all(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  /// Runs balls with the list and with another structure.
  RunResult run(const StructureEntry& entry, const std::string& more = "") {
    const std::string text = R"({"name": "t", "matrix": {"scene": "spd:balls:1", "structure": [{"name": "list"}, {"name": "grid"}], "isa": "scalar"},
      "image": {"width": 16, "height": 16}, "measure": {"samples": 3})" +
                             more + "}";
    const Config config = parse_config(text, "c.json", {}, [](const std::string&) -> const char* { return nullptr; });
    std::vector<Experiment> cells = expand(config);
    cells.back().structure = &entry;
    cells.back().params = {};
    RunOptions options;
    options.out = folder_.string();
    options.pin = "none";
    std::ostringstream messages;
    Progress progress(messages, ProgressStyle::none);
    return run_experiment(config, cells, options, progress);
  }
  [[nodiscard]] RunRecords records() const { return read_run_log(folder_ / "samples.jsonl"); }
  /// The line of summary.csv that names the structure.
  [[nodiscard]] std::string summary(const std::string& structure) const {
    std::ifstream file(folder_ / "summary.csv");
    for (std::string line; std::getline(file, line);) {
      if (line.find("," + structure + ",") != std::string::npos) return line;
    }
    return {};
  }

  std::filesystem::path folder_;
};

TEST_F(Runner, HoldsTheWalksOfGridsAgainstTheTruthWhereAskedTo) {
  for (const bool oracle : {true, false}) {
    for (const bool asked : {true, false}) {
      SCOPED_TRACE(std::string(oracle ? "oracle" : "no oracle") + (asked ? ", asked" : ""));
      std::filesystem::remove_all(folder_);
      run(structure_entry("grid"),
          std::string(R"(, "verify": {"oracle": )") + (oracle ? "true" : "false") + R"(, "cells": )" + (asked ? "true" : "false") + "}");
      std::size_t walks = 0;
      for (const auto& [cell, check] : records().checks) {
        EXPECT_EQ(check.accuracy.has_value(), oracle) << cell;
        if (!check.cells) continue;
        ++walks;
        EXPECT_EQ(check.cells->rays_checked, 256);
        EXPECT_EQ(check.cells->rays_at_risk, 0);
      }
      EXPECT_EQ(walks, asked ? 1u : 0u) << "of the grid, none of the list";
      std::ifstream table(folder_ / "accuracy.csv");
      EXPECT_EQ(std::count(std::istreambuf_iterator<char>(table), {}, '\n'), 1 + (oracle ? 2 : asked ? 1 : 0));
    }
  }
}

TEST_F(Runner, DoesNotTimeWrongHits) {
  for (const char* verify : {R"(, "verify": {"oracle": true})", R"(, "verify": {"oracle": false})"}) {
    const StructureEntry liar = lying_entry<false>("liar");
    const RunResult result = run(liar, verify);
    EXPECT_EQ(result.cells.at(Status::wrong), 1u);
    EXPECT_EQ(result.cells.at(Status::ok), 1u);
    ASSERT_EQ(result.complaints.size(), 1u);
    EXPECT_NE(result.complaints.front().find("1 of 256 rays have wrong hits"), std::string::npos) << result.complaints.front();
    EXPECT_EQ(records().samples.size(), 1u);
    EXPECT_NE(summary("liar").find(",1,wrong"), std::string::npos) << summary("liar");
    EXPECT_NE(summary("liar").find(",0,,,,,,"), std::string::npos) << summary("liar");  // no samples, no times
    TearDown();
  }
}

TEST_F(Runner, HoldsEveryTimedPassAgainstTheVerifiedHits) {
  const StructureEntry liar = lying_entry<true>("sly");
  const RunResult result = run(liar);
  EXPECT_EQ(result.cells.at(Status::wrong), 1u);
  ASSERT_EQ(result.complaints.size(), 1u);
  EXPECT_NE(result.complaints.front().find("a timed pass gave other hits than the counted one"), std::string::npos);
  EXPECT_NE(summary("sly").find(",0,,,,,,"), std::string::npos) << summary("sly");
}

TEST_F(Runner, AcceptsAShareOfMismatchesOnlyWhereTheConfigSaysSo) {
  const StructureEntry liar = lying_entry<false>("liar");
  EXPECT_EQ(run(liar, R"(, "verify": {"hit_mismatch_max": 0.01})").cells.at(Status::ok), 2u);  // 1 of 256
  EXPECT_NE(summary("liar").find(",1,ok"), std::string::npos) << summary("liar");
}

TEST(Pass, IsEstimatedFromWholePacketsOfAllOfIt) {
  for (const int size : {0, 1, 63, 64, 65, 200, 1000, 100000}) {
    RaySet set;
    set.query = Query::any;
    for (int i = 0; i < size; ++i) set.rays.push_back({{static_cast<float>(i), 0, 0}, 0, {0, 0, 1}, 1});
    const RaySet few = sample_of(set, 8);
    EXPECT_EQ(few.query, Query::any);
    ASSERT_EQ(few.rays.size(), static_cast<std::size_t>(std::min(size, 8 * kMaxPacket))) << size;
    for (std::size_t i = 0; i < few.rays.size(); ++i) {
      const int index = static_cast<int>(few.rays[i].org[0]), first = static_cast<int>(few.rays[i / kMaxPacket * kMaxPacket].org[0]);
      ASSERT_EQ(first % kMaxPacket, 0) << size;
      ASSERT_EQ(index - first, static_cast<int>(i % kMaxPacket)) << size;
      if (size > 8 * kMaxPacket) {
        ASSERT_NEAR(first, static_cast<double>(i / kMaxPacket) * size / 8, kMaxPacket) << size;
      }
    }
  }
}

TEST_F(Runner, RecordsAnInstructionSetThatIsMissing) {
  if (available(kIsas.back())) GTEST_SKIP() << "this machine has all instruction sets";
  const std::string text = R"({"name": "t", "matrix": {"scene": "spd:balls:1", "structure": {"name": "list"}, "isa": "avx512"}})";
  const Config config = parse_config(text, "c.json", {}, [](const std::string&) -> const char* { return nullptr; });
  RunOptions options;
  options.out = folder_.string();
  std::ostringstream messages;
  Progress progress(messages, ProgressStyle::none);
  const RunResult result = run_experiment(config, expand(config), options, progress);
  EXPECT_EQ(result.cells.at(Status::skipped), 1u);
  EXPECT_NE(result.complaints.front().find("this machine has no avx512"), std::string::npos);
}

}  // namespace
}  // namespace raymeter
