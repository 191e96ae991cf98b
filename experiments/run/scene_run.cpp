#include "experiments/run/scene_run.h"

#include <algorithm>
#include <chrono>
#include <new>

#include <fmt/format.h>

#include "accel/registry.h"
#include "accel/weak_settings.h"
#include "core/base/error.h"
#include "core/base/threads.h"
#include "core/scene/scene_needs.h"
#include "experiments/cases/hard_case.h"
#include "experiments/config/hash.h"
#include "experiments/npy.h"
#include "experiments/record/tables.h"
#include "experiments/run/verification.h"
#include "experiments/scenes/scene_source.h"

namespace raymeter {

namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) { return std::chrono::duration<double, std::milli>(Clock::now() - start).count(); }

/// Checking a cell costs about as much as this many passes: an estimate, a reference's share, a counted pass.
constexpr std::int64_t kCheckPasses = 3;

ParamValues defaults_of(const StructureEntry& entry) { return entry.resolve({}); }

void apply(const SceneView& view, Scene& scene) {
  scene.camera = {.eye = view.eye, .look_at = view.look_at, .up = view.up, .fov_degrees = view.fov_degrees};
  if (view.light) scene.lights = {{*view.light}};
}

}  // namespace

std::size_t RunContext::cells_done() const {
  return static_cast<std::size_t>(std::count_if(cells.begin(), cells.end(), [&](const Experiment& cell) { return status(cell) != Status::unfinished; }));
}

std::int64_t passes_of(const Config& config) { return kCheckPasses + config.measure.warmup + config.measure.samples; }

SceneRun::SceneRun(RunContext& context, std::span<const Experiment> cells) : context_(context), cells_(cells) {}
SceneRun::~SceneRun() = default;

void SceneRun::run() {
  skip_absent_scene();
  skip_missing_isas();
  if (std::none_of(cells_.begin(), cells_.end(), [&](const Experiment& cell) { return unfinished(cell); })) return;
  load();
  skip_what_cannot_serve();
  build_all();
  time_builds();
  if (context_.stop.requested()) return;
  make_ray_sets();
  check_all();
  time_all();
}

void SceneRun::tell(const std::string& what) { context_.progress.step(cells_.front().scene.name, what, context_.cells_done(), context_.cells.size()); }

void SceneRun::end(const Experiment& cell, Status status, const std::string& reason) {
  CheckRecord record;
  record.cell = cell.id;
  record.status = status;
  record.reason = reason;
  record.threads = cell.threads > 0 ? cell.threads : all_threads();
  context_.log.add(record);
  context_.progress.add(passes_of(context_.config));
}

void SceneRun::skip_absent_scene() {
  for (const Experiment& cell : cells_) {
    if (!cell.scene.absent.empty() && unfinished(cell)) end(cell, Status::skipped, cell.scene.absent);
  }
}

void SceneRun::skip_missing_isas() {
  for (const Experiment& cell : cells_) {
    if (!unfinished(cell) || available(cell.isa)) continue;
    end(cell, Status::skipped, fmt::format("this machine has no {}", name(cell.isa)));
  }
}

void SceneRun::skip_what_cannot_serve() {
  for (const Experiment& cell : cells_) {
    if (!unfinished(cell)) continue;
    if (cell.structure->why_not != nullptr) {
      if (const std::string why = cell.structure->why_not(*scene_, cell.isa); !why.empty()) end(cell, Status::skipped, why);
    }
    if (answers_for_itself(*cell.structure, cell.params) && cell.rays.image() && unfinished(cell))
      end(cell, Status::skipped,
          fmt::format("images have to equal the reference's bit for bit, and those of {} need not", cell.structure->peer ? "a peer" : "weak tests"));
  }
}

void SceneRun::load() {
  tell("loading");
  const SceneChoice& choice = cells_.front().scene;
  const auto start = Clock::now();
  scene_ = std::make_unique<Scene>(load_scene(choice.spec));
  if (choice.view) apply(*choice.view, *scene_);
  lights_ = light_targets(*scene_, scene_->lights, 0);
  const SceneRecord record{choice.name, hex_text(scene_->hash()), scene_->prim_count(), needs_of(*scene_).text(), scene_->mem_bytes(), ms_since(start)};
  const auto& known = context_.log.records().scenes;
  const auto before = known.find(choice.name);
  if (before == known.end())
    context_.log.add(record);
  else if (before->second.hash != record.hash)
    throw Error(fmt::format("{}: has changed since the run began; --fresh starts anew", choice.name));
  list_ = structure_entry("list").build(*scene_, defaults_of(structure_entry("list")), 0);
  if (context_.config.verify.oracle) oracle_ = std::make_unique<Oracle>(*scene_);
}

void SceneRun::build_all() {
  std::vector<std::pair<std::string, std::vector<const Experiment*>>> builds;  // in the order of the cells
  for (const Experiment& cell : cells_) {
    if (!unfinished(cell)) continue;
    const std::string text = build_text(cell);
    auto found = std::find_if(builds.begin(), builds.end(), [&](const auto& build) { return build.first == text; });
    if (found == builds.end()) found = builds.insert(builds.end(), {text, {}});
    found->second.push_back(&cell);
  }
  for (const auto& [text, cells] : builds) {
    if (context_.stop.requested()) return;
    build(text, cells);
  }
}

/// Builds once for each number of threads whose time is not known yet; the structures are the same, one is kept.
void SceneRun::build(const std::string& text, std::span<const Experiment* const> cells) {
  std::unique_ptr<Structure>& structure = structures_[text];
  tell("building " + text);
  try {
    for (const Experiment* cell : cells) {
      if (structure && context_.log.records().builds.contains({cell->scene.name, text, cell->threads})) continue;
      structure.reset();
      const auto start = Clock::now();
      structure = cell->structure->build(*scene_, cell->params, cell->threads);
      const double build_ms = ms_since(start);
      if (context_.log.records().builds.contains({cell->scene.name, text, cell->threads})) continue;
      BuildRecord record{cell->scene.name, text, cell->threads, {build_ms}, structure->stats()};
      if (cell->structure->add_quality != nullptr) cell->structure->add_quality(*scene_, cell->params, 0, record.stats);
      context_.log.add(record);
    }
  } catch (const std::bad_alloc&) {
    for (const Experiment* cell : cells) end(*cell, Status::failed, "out of memory while building");
  } catch (const Error& error) {
    for (const Experiment* cell : cells) end(*cell, Status::refused, error.what());
  }
}

void SceneRun::make_ray_sets() {
  // Primary hits that secondary rays start from: on the instruction set that every machine has, so that the rays are the same everywhere.
  const StructureEntry& entry = structure_entry("bvh");
  const ParamValues params = defaults_of(entry);
  bvh_ = entry.build(*scene_, params, 0);
  const std::unique_ptr<Intersector> tracer = bvh_->intersector({Isa::scalar, 1, params});
  for (const Experiment& cell : cells_) {
    if (!unfinished(cell)) continue;
    if (cell.rays.image()) {
      add_live(cell, nullptr);
      continue;
    }
    const auto [found, added] = ray_sets_.try_emplace(cell.rays.name);
    if (added) {
      tell("making " + cell.rays.name + " rays");
      found->second = make_ray_set(cell, *tracer);
    }
    const RaySet& rays = found->second;
    if (rays.rays.size() == 0) {
      end(cell, Status::skipped, "no such rays: nothing is hit, or the file is empty");
      continue;
    }
    add_live(cell, &rays);
  }
}

void SceneRun::add_live(const Experiment& cell, const RaySet* rays) {
  try {
    live_.push_back(make_live(cell, rays));
  } catch (const Error& error) {
    end(cell, Status::refused, error.what());
  }
}

SceneRun::Live SceneRun::make_live(const Experiment& cell, const RaySet* rays) const {
  Live live;
  live.cell = &cell;
  live.rays = rays;
  live.frame = {scene_.get(), {scene_->camera, cell.camera, cell.width, cell.height}, {cell.max_depth, cell.min_weight}, cell.general, &lights_};
  live.intersector = structures_.at(build_text(cell))->intersector({cell.isa, cell.packet, cell.params});
  const auto fill = [&](const auto& chosen, const auto& default_row, auto& slot) {
    if (chosen.entry != &default_row) slot = chosen.entry->make(*scene_, {cell.isa, cell.packet, cell.threads, chosen.params}, *live.intersector);
  };
  fill(cell.first_hit, first_hits().front(), live.first_hit);
  fill(cell.occlusion, occlusions().front(), live.occlusion);
  return live;
}

RaySet SceneRun::make_ray_set(const Experiment& cell, const Intersector& tracer) const {
  if (!cell.rays.file.empty()) return {.rays = read_rays_npy(cell.rays.file), .query = cell.rays.any ? Query::any : Query::closest, .pixel = {}};
  if (cell.rays.name == "case") return hard_case(cell.scene.spec).make(cell.width * cell.height, cell.seed).set;
  const CameraModel model{scene_->camera, cell.camera, cell.width, cell.height};
  return make_rays(*scene_, ray_recipe_from_name(cell.rays.name).value(), model, cell.seed, tracer, 0);
}

}  // namespace raymeter
