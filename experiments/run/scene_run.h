#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "experiments/config/config.h"
#include "experiments/record/run_log.h"
#include "experiments/run/pass.h"
#include "experiments/run/pin.h"
#include "experiments/run/progress.h"
#include "experiments/run/stop.h"
#include "experiments/run/verification.h"

namespace raymeter {

class FrameVerification;
class Oracle;

/// What all scenes of a run share.
struct RunContext {
  const Config& config;
  const std::vector<Experiment>& cells;
  RunLog& log;
  Progress& progress;
  Pinning& pinning;
  const Stop& stop;

  [[nodiscard]] Status status(const Experiment& cell) const { return log.records().status(cell.id, config.measure.samples); }
  [[nodiscard]] std::size_t cells_done() const;
};

/// Passes that a cell takes in all: what progress is counted in.
[[nodiscard]] std::int64_t passes_of(const Config& config);

/// Runs the unfinished cells of one scene: every structure is built, every ray set made once, every cell verified and counted; then the timed passes of
/// all cells in rounds, each in a seeded order, so that a slow spell of the machine hits all alike. Builds for time alone come before, in rounds likewise.
/// Stops between two steps where that is requested.
class SceneRun {
public:
  SceneRun(RunContext& context, std::span<const Experiment> cells);
  ~SceneRun();
  void run();

private:
  /// A cell that still has something to do.
  struct Live {
    const Experiment* cell = nullptr;
    const RaySet* rays = nullptr;  ///< or else frames
    Frame frame;
    std::unique_ptr<Intersector> intersector;
    std::unique_ptr<FirstHit> first_hit;   ///< null where the slot holds its default
    std::unique_ptr<Occlusion> occlusion;  ///< likewise
    double spent_s = 0;                    ///< of timeout_s, in this session
    double pass_s = 0;                     ///< the last one
    [[nodiscard]] Tracers tracers() const noexcept { return {*intersector, first_hit.get(), occlusion.get()}; }
  };

  void skip_absent_scene();
  void skip_missing_isas();
  void skip_what_cannot_serve();
  void load();
  void build_all();
  void build(const std::string& build, std::span<const Experiment* const> cells);
  void time_builds();
  void time_build(const Experiment& cell, int round);
  void make_ray_sets();
  void add_live(const Experiment& cell, const RaySet* rays);
  [[nodiscard]] Live make_live(const Experiment& cell, const RaySet* rays) const;
  [[nodiscard]] RaySet make_ray_set(const Experiment& cell, const Intersector& tracer) const;
  void check_all();
  /// Takes from the cell's intersector what it has made for rays.
  void forget_made(Live& live) const;
  void check_ray_sets(std::span<Live* const> group);
  void check_ray_set(Live& live, const Verification& verification);
  void check_frames(std::span<Live* const> group);
  void check_frame(Live& live, FrameVerification& verification);
  [[nodiscard]] std::vector<Live*> affordable(std::span<Live* const> group);
  [[nodiscard]] double estimate_s(const Live& live) const;
  void add_check(const CheckRecord& record);
  [[nodiscard]] std::unique_ptr<Intersector> reference_for(const Experiment& cell, double rays);
  void time_all();
  void time_round(int round, bool warmup);
  [[nodiscard]] SampleRecord timed(Live& live);
  void time_pass(Live& live, int round, bool warmup);
  void end(const Experiment& cell, Status status, const std::string& reason);
  [[nodiscard]] bool unfinished(const Experiment& cell) const { return context_.status(cell) == Status::unfinished; }
  void tell(const std::string& what);

  RunContext& context_;
  std::span<const Experiment> cells_;
  std::unique_ptr<Scene> scene_;
  std::vector<LightTarget> lights_;
  std::unique_ptr<Oracle> oracle_;
  std::unique_ptr<Structure> list_;                               ///< the reference of all
  std::unique_ptr<Structure> bvh_;                                ///< finds what secondary rays start from
  std::map<std::string, std::unique_ptr<Structure>> structures_;  ///< by build
  std::map<std::string, RaySet> ray_sets_;                        ///< by name
  std::map<const RaySet*, Judgements> judgements_;
  std::vector<Live> live_;
  Answers answers_;
};

}  // namespace raymeter
