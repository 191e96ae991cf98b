// Whole images as experiments measure them.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include <unistd.h>

#include "accel/registry.h"
#include "core/base/error.h"
#include "experiments/config/expand.h"
#include "experiments/record/run_log.h"
#include "experiments/run/runner.h"

namespace raymeter {
namespace {

Config parsed(const std::string& matrix, const std::string& more = "") {
  const std::string text = R"({"name": "t", "matrix": {"scene": "spd:balls:1", "structure": [{"name": "list"}, {"name": "bvh"}], "isa": "scalar", )" + matrix +
                           R"(}, "image": {"width": 24, "height": 16}, "measure": {"samples": 3})" + more + "}";
  return parse_config(text, "c.json", {}, [](const std::string&) -> const char* { return nullptr; });
}

TEST(FrameCells, OnlyImagesHaveDepthsAndWeights) {
  const Config config = parsed(R"("rays": ["primary", "image"], "max_depth": [3, 5], "min_weight": [0, 0.1, 2])");
  std::size_t images = 0;
  for (const Experiment& cell : expand(config)) {
    if (cell.rays.image()) {
      ++images;
    } else {
      EXPECT_EQ(cell.max_depth, 5);
      EXPECT_EQ(cell.min_weight, 0);
    }
  }
  EXPECT_EQ(images, 2u * 2 * 3);
  EXPECT_EQ(expand(config).size(), images + 2) << "a ray set does not multiply with depths";
}

TEST(FrameCells, RaySetsKeepTheirIdsWhateverImagesVary) {
  const auto ids = [](const std::string& matrix) {
    std::set<std::string> found;
    for (const Experiment& cell : expand(parsed(matrix))) {
      if (!cell.rays.image()) found.insert(cell.id);
    }
    return found;
  };
  const std::set<std::string> alone = ids(R"("rays": ["primary", "shadow"])");
  EXPECT_EQ(alone.size(), 4u);
  EXPECT_EQ(ids(R"("rays": ["image", "primary", "shadow"], "max_depth": [1, 7], "min_weight": 0.5)"), alone);
}

TEST(FrameCells, IdsSayWhichCameraAndDepth) {
  std::set<std::string> ids;
  for (const char* more : {"", R"(, "camera": "spd")", R"(, "camera": "havran")"}) {
    Config config = parsed(R"("rays": ["image", "primary"], "max_depth": [2, 3], "min_weight": [0, 0.1])");
    config.camera =
        parse_config(std::string(R"({"name": "t", "matrix": {"scene": "spd:balls:1", "structure": {"name": "list"}}, "image": {"width": 4)") + more + "}}",
                     "c.json", {}, [](const std::string&) -> const char* { return nullptr; })
            .camera;
    for (const Experiment& cell : expand(config)) ids.insert(cell.id);
  }
  EXPECT_EQ(ids.size(), 3u * 2 * (2 * 2 + 1));
}

TEST(FrameCells, DepthsWithoutImagesAreAnError) {
  const auto message = [](const std::string& matrix) -> std::string {
    try {
      (void)parsed(matrix);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(message(R"("max_depth": 4)"), "c.json: matrix.max_depth: ray sets have no depth, expected \"image\" among matrix.rays");
  EXPECT_EQ(message(R"("rays": "shadow", "min_weight": [0, 0.1])"),
            "c.json: matrix.min_weight: ray sets have no weights, expected \"image\" among matrix.rays");
  EXPECT_EQ(message(R"("max_depth": 5, "min_weight": 0)"), "no error");
  EXPECT_EQ(message(R"("rays": "image", "max_depth": 0)"), "c.json: matrix.max_depth: expected a whole number from 1 to 100, got 0");
}

/// Blocks the first free shadow ray of every slice: always, or only while it is timed.
class ShadingIntersector final : public Intersector {
public:
  ShadingIntersector(std::unique_ptr<Intersector> honest, bool only_timed) : honest_(std::move(honest)), only_timed_(only_timed) {}
  [[nodiscard]] std::size_t scratch_bytes() const noexcept override { return honest_->scratch_bytes(); }
  void closest_hit(const RayView& rays, const HitView& hits, Counters* counters, std::byte* scratch) const noexcept override {
    honest_->closest_hit(rays, hits, counters, scratch);
  }
  void any_hit(const RayView& rays, std::int32_t* blocker, Counters* counters, std::byte* scratch) const noexcept override {
    honest_->any_hit(rays, blocker, counters, scratch);
    if (only_timed_ && counters != nullptr) return;
    for (int i = 0; i < rays.count; ++i) {
      if (blocker[i] >= 0) continue;
      blocker[i] = 0;
      return;
    }
  }

private:
  std::unique_ptr<Intersector> honest_;
  bool only_timed_;
};

template <bool kOnlyTimed>
class ShadingStructure final : public Structure {
public:
  explicit ShadingStructure(const Scene& scene) : list_(structure_entry("list").build(scene, {}, 1)) {}
  [[nodiscard]] const BuildStats& stats() const noexcept override { return list_->stats(); }
  [[nodiscard]] std::unique_ptr<Intersector> intersector(const QueryOptions& options) const override {
    return std::make_unique<ShadingIntersector>(list_->intersector(options), kOnlyTimed);
  }

private:
  std::unique_ptr<Structure> list_;
};

template <bool kOnlyTimed>
StructureEntry shading_entry() {
  const StructureEntry& list = structure_entry("list");
  return {"shady",
          "blocks free rays",
          "nobody",
          list.params,
          list.resolve,
          [](const Scene& scene, const ParamValues&, int) -> std::unique_ptr<Structure> { return std::make_unique<ShadingStructure<kOnlyTimed>>(scene); }};
}

class FrameRun : public testing::Test {
protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("raymeter_frames_test_" + std::to_string(::getpid()));
    std::filesystem::remove_all(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  RunResult run(const Config& config, const std::vector<Experiment>& cells, bool resume = false) {
    RunOptions options;
    options.out = folder_.string();
    options.pin = "none";
    options.resume = resume;
    std::ostringstream messages;
    Progress progress(messages, ProgressStyle::none);
    return run_experiment(config, cells, options, progress);
  }
  [[nodiscard]] RunRecords records() const { return read_run_log(folder_ / "samples.jsonl"); }

  std::filesystem::path folder_;
};

TEST_F(FrameRun, GivesWrongImagesNoTiming) {
  const StructureEntry shady = shading_entry<false>();
  const Config config = parsed(R"("rays": "image")");
  std::vector<Experiment> cells = expand(config);
  cells.back().structure = &shady;
  cells.back().params = {};
  const RunResult result = run(config, cells);
  EXPECT_EQ(result.cells.at(Status::ok), 1u);
  EXPECT_EQ(result.cells.at(Status::wrong), 1u);
  ASSERT_EQ(result.complaints.size(), 1u);
  EXPECT_NE(result.complaints.front().find("of 384 pixels are wrong"), std::string::npos) << result.complaints.front();
  EXPECT_FALSE(records().samples.contains(cells.back().id));
}

TEST_F(FrameRun, ChecksEveryTimedFrame) {
  const StructureEntry sly = shading_entry<true>();
  const Config config = parsed(R"("rays": "image")");
  std::vector<Experiment> cells = expand(config);
  cells.back().structure = &sly;
  cells.back().params = {};
  const RunResult result = run(config, cells);
  EXPECT_EQ(result.cells.at(Status::wrong), 1u);
  EXPECT_NE(result.complaints.front().find("a timed pass gave"), std::string::npos) << result.complaints.front();
}

TEST_F(FrameRun, RecordsPhasesRaysAndErrors) {
  const Config config = parsed(R"("rays": "image", "min_weight": [0, 2])");
  const std::vector<Experiment> cells = expand(config);
  EXPECT_EQ(run(config, cells).cells.at(Status::ok), 4u);
  const RunRecords log = records();
  for (const Experiment& cell : cells) {
    const CheckRecord& check = log.checks.at(cell.id);
    ASSERT_TRUE(check.frame.has_value());
    const FrameRecord& frame = *check.frame;
    EXPECT_EQ(frame.rays.primary, 384);
    EXPECT_EQ(check.rays, frame.rays.all());
    EXPECT_EQ(check.counters->ray_count, static_cast<std::uint64_t>(frame.rays.all()));
    EXPECT_EQ(frame.counters[static_cast<std::size_t>(FramePhase::shadow)].ray_count, static_cast<std::uint64_t>(frame.rays.shadow));
    EXPECT_EQ(check.hit_mismatch, 0);
    EXPECT_GT(check.accuracy->rays_checked, 384) << "eye rays and others";
    const bool cut = cell.min_weight > 0;
    EXPECT_EQ(frame.error.rmse > 0, cut);
    EXPECT_EQ(frame.bound.error_max > 0, cut);
    EXPECT_GE(frame.bound.bound_max, frame.bound.error_max);
    EXPECT_GE(frame.bound.bound_mean, frame.bound.error_mean);
    EXPECT_EQ(frame.bound.exceeded, 0);
    EXPECT_EQ(frame.rays_full > frame.rays.all(), cut);
    EXPECT_EQ(frame.rays.reflection > 0, !cut);
    for (const auto& [index, sample] : log.samples.at(cell.id)) {
      ASSERT_TRUE(sample.phases.has_value());
      PhaseSample sum;
      for (const PhaseSample& phase : *sample.phases) {
        sum.ms += phase.ms;
        sum.rays += phase.rays;
        EXPECT_GE(phase.ms, 0);
      }
      EXPECT_EQ(sum.rays, sample.rays);
      EXPECT_LE(sum.ms, sample.trace_ms);
    }
  }
}

TEST_F(FrameRun, ContinuesWhereItStopped) {
  const Config config = parsed(R"("rays": ["image", "primary"])");
  const std::vector<Experiment> cells = expand(config);
  run(config, cells);
  const std::filesystem::path log = folder_ / "samples.jsonl";
  std::ifstream file(log);
  std::string kept, line;
  for (int lines = 0; lines < 9 && std::getline(file, line); ++lines) kept += line + '\n';
  file.close();
  std::ofstream(log) << kept;
  EXPECT_EQ(run(config, cells, true).cells.at(Status::ok), 4u);
  for (const Experiment& cell : cells) EXPECT_EQ(records().samples_of(cell.id), 3);
}

TEST_F(FrameRun, TablesHaveARowForEveryPhase) {
  const Config config = parsed(R"("rays": "image")");
  run(config, expand(config));
  const auto phases = [&](const char* table) {
    std::ifstream file(folder_ / (std::string(table) + ".csv"));
    std::string header;
    std::getline(file, header);
    std::multiset<std::string> found;
    for (std::string line; std::getline(file, line);) {
      for (const char* phase : {"build", "total", "first_hit", "shadow", "reflection", "refraction", "shading"}) {
        if (line.find(",image," + std::string(phase) + ",") != std::string::npos) found.insert(phase);
      }
    }
    return found;
  };
  using Phases = std::multiset<std::string>;
  const Phases each{"total", "first_hit", "shadow", "reflection", "shading"};  // nothing is transparent
  Phases cells, counted, timed;
  for (const std::string& phase : each) {
    for (int cell = 0; cell < 2; ++cell) {
      cells.insert(phase);
      if (phase != "shading") counted.insert(phase);
      for (int sample = 0; sample < 3; ++sample) timed.insert(phase);
    }
  }
  EXPECT_EQ(phases("summary"), cells);
  EXPECT_EQ(phases("counters"), counted);
  EXPECT_EQ(phases("samples"), timed);
  EXPECT_EQ(phases("frames"), (Phases{"total", "total"}));
  EXPECT_EQ(phases("accuracy"), (Phases{"total", "total"}));
  EXPECT_EQ(phases("builds"), (Phases{"build", "build"}));
}

}  // namespace
}  // namespace raymeter
