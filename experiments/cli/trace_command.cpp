#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>

#include "accel/registry.h"
#include "core/base/error.h"
#include "core/base/threads.h"
#include "core/trace/trace.h"
#include "experiments/cli/choices.h"
#include "experiments/cli/cli.h"
#include "experiments/npy.h"
#include "experiments/record/trace_stats.h"
#include "experiments/scenes/scene_source.h"

namespace raymeter {

namespace {

/// Rays per packet of user's batches: fills the widest register; how coherent the rays are is not known.
constexpr int kPacket = 16;

struct TraceOptions {
  std::string scene, technique, rays, query, out, isa, stats;
  std::string threads = "all";
};

double elapsed_ms(std::chrono::steady_clock::time_point since) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - since).count();
}

/// Traces, writes the hits into `out`; where `counting`, once more with the counting kernels.
void trace_into(AtomicFile& out, Intersector& intersector, const RayBatch& rays, bool counting, TraceStats& stats) {
  Counters* const counters = counting ? &stats.counters : nullptr;
  const auto start = std::chrono::steady_clock::now();
  intersector.prepare(rays.view(), stats.query == "closest" ? Query::closest : Query::any, stats.threads);
  if (stats.query == "closest") {
    HitBatch hits;
    trace_closest(intersector, rays, hits, stats.threads);
    stats.trace_ms = elapsed_ms(start);
    stats.hits = static_cast<std::size_t>(std::count_if(hits.prim.begin(), hits.prim.end(), [](std::int32_t prim) { return prim >= 0; }));
    write_hits_npy(out, hits);
    if (counters != nullptr) trace_closest(intersector, rays, hits, stats.threads, counters);
  } else {
    Column<std::int32_t> blocker;
    trace_any(intersector, rays, blocker, stats.threads);
    stats.trace_ms = elapsed_ms(start);
    stats.hits = static_cast<std::size_t>(std::count_if(blocker.begin(), blocker.end(), [](std::int32_t prim) { return prim >= 0; }));
    write_blocked_npy(out, blocker);
    if (counters != nullptr) trace_any(intersector, rays, blocker, stats.threads, counters);
  }
}

ExitCode trace(const TraceOptions& options) {
  TraceStats stats;
  stats.technique = parse_technique(options.technique);
  if (stats.technique.first_hit.entry != &first_hits().front() || stats.technique.occlusion.entry != &occlusions().front()) {
    throw Error("--technique: a file's rays have neither eye nor light, expected a structure alone");
  }
  stats.query = options.query;
  stats.isa = chosen_isa(options.isa);
  stats.packet = kPacket;
  stats.threads = chosen_threads(options.threads);
  AtomicFile out(options.out);
  std::optional<AtomicFile> stats_file;
  if (!options.stats.empty()) stats_file.emplace(options.stats);
  const RayBatch rays = read_rays_npy(options.rays);
  const Scene scene = load_scene(options.scene);
  stats.scene = options.scene;
  stats.num_prims = scene.prim_count();
  stats.rays = rays.size();

  const auto start = std::chrono::steady_clock::now();
  const std::unique_ptr<Structure> structure = stats.technique.structure->build(scene, stats.technique.params, stats.threads);
  stats.build_ms = elapsed_ms(start);
  stats.build = structure->stats();
  const std::unique_ptr<Intersector> intersector = structure->intersector({stats.isa, stats.packet, stats.technique.params});
  trace_into(out, *intersector, rays, stats_file.has_value(), stats);
  stats.choice = choices(*intersector);
  if (stats.threads == 0) stats.threads = all_threads();
  if (stats_file) {
    stats_file->write(trace_stats_json(stats));
    stats_file->commit();
  }
  out.commit();
  return ExitCode::success;
}

}  // namespace

void add_trace(Cli& cli) {
  auto options = std::make_shared<TraceOptions>();
  CLI::App& command = cli.add_command("trace", "raymeter trace --scene spd:balls:3 --technique bvh --rays rays.npy --query closest --out hits.npy",
                                      "Traces rays from a NumPy file, float32 of shape (N, 8): ox oy oz tmin dx dy dz tmax, and writes their hits as one.");
  command.add_option("--scene", options->scene, "Generator (spd:balls:4) or file")->required();
  command.add_option("--technique", options->technique, "STRUCTURE[:key=value,...], see 'raymeter list techniques'")->required();
  command.add_option("--rays", options->rays, "The rays")->required();
  command.add_option("--query", options->query, "closest: structured t prim u v; any: uint8")->required()->check(CLI::IsMember({"closest", "any"}));
  command.add_option("--out", options->out, "Where the hits go")->required();
  command.add_option("--isa", options->isa, "Instruction set; default: the machine's best");
  command.add_option("--threads", options->threads, "Number of threads or all")->capture_default_str();
  command.add_option("--stats", options->stats, "Write counters, build quality and times to this JSON file");
  command.callback([&cli, options] { cli.action = [options] { return trace(*options); }; });
}

}  // namespace raymeter
