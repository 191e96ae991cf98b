#include <algorithm>
#include <charconv>
#include <memory>
#include <numeric>
#include <optional>
#include <ostream>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/base/threads.h"
#include "core/render/heat_map.h"
#include "core/render/whitted.h"
#include "core/trace/trace.h"
#include "experiments/atomic_file.h"
#include "experiments/cli/choices.h"
#include "experiments/cli/cli.h"
#include "experiments/image/picture.h"
#include "experiments/record/image_stats.h"
#include "experiments/scenes/scene_source.h"

namespace raymeter {

namespace {

/// Pixels on a side, and in all, at most.
constexpr int kMaxSide = 65536;
constexpr std::int64_t kMaxPixels = 1 << 28;

struct ImageOptions {
  std::string scene, technique, out, size, isa, stats, heatmap;
  std::string camera = "pixel", threads = "all";
  Termination termination;
  int packet = 16;
};

struct Size {
  int width;
  int height;
};

/// "W" or "WxH"; empty where the scene is to say.
std::optional<Size> chosen_size(const std::string& text) {
  if (text.empty()) return std::nullopt;
  const auto read = [&](std::string_view digits) {
    int side = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), side);
    if (error != std::errc{} || end != digits.data() + digits.size() || side < 1 || side > kMaxSide) {
      throw Error(fmt::format("--size: expected W or WxH, whole numbers from 1 to {}, got '{}'", kMaxSide, text));
    }
    return side;
  };
  const auto cross = text.find('x');
  const int width = read(std::string_view(text).substr(0, cross));
  return Size{width, cross == std::string::npos ? width : read(std::string_view(text).substr(cross + 1))};
}

CameraConvention chosen_camera(const std::string& text) {
  if (const auto convention = camera_convention_from_name(text)) return *convention;
  throw Error("--camera: expected spd, havran or pixel, got '" + text + "'");
}

/// The heat map's picture; its scale goes to `stats`.
Picture heat_map(const std::string& of_what, Intersector& intersector, ImageStats& stats) {
  const Event event = of_what == "nodes" ? Event::node_visit : Event::prim_test;
  const Column<std::uint64_t> counts = events_per_pixel(stats.model, intersector, event, stats.threads);
  const std::uint64_t most = *std::max_element(counts.begin(), counts.end());
  const double sum = std::accumulate(counts.begin(), counts.end(), 0.0);
  stats.heatmap = {of_what == "nodes" ? "node_visits" : "prim_tests", most, sum / static_cast<double>(counts.size())};
  return heat_picture(stats.model.width, stats.model.height, counts.span(), most);
}

/// What the options say; the scene's own size where they say none.
ImageStats chosen_stats(const ImageOptions& options) {
  ImageStats stats;
  stats.technique = parse_technique(options.technique);
  stats.isa = chosen_isa(options.isa);
  stats.packet = options.packet;
  stats.threads = chosen_threads(options.threads);
  stats.termination = options.termination;
  if (!(stats.termination.min_weight >= 0)) throw Error(fmt::format("--min-weight: expected a number from 0, got {}", stats.termination.min_weight));
  stats.model.convention = chosen_camera(options.camera);
  stats.scene = options.scene;
  return stats;
}

void look_at(const Scene& scene, const std::optional<Size>& size, ImageStats& stats) {
  stats.num_prims = scene.prim_count();
  stats.model.camera = scene.camera;
  stats.model.width = size ? size->width : scene.camera.width;
  stats.model.height = size ? size->height : scene.camera.height;
  if (std::int64_t{stats.model.width} * stats.model.height > kMaxPixels) {
    throw Error(fmt::format("--size: {}x{} is more than {} pixels", stats.model.width, stats.model.height, kMaxPixels));
  }
}

/// The image's picture; what it took goes to `stats`, counted where `count` says so.
Picture rendered(const Scene& scene, Intersector& intersector, bool count, ImageStats& stats) {
  const auto make = [&](const auto& slot) { return slot.entry->make(scene, {stats.isa, stats.packet, stats.threads, slot.params}, intersector); };
  const auto first_hit = make(stats.technique.first_hit);
  const auto occlusion = make(stats.technique.occlusion);
  const Rendering rendering = render(scene, *first_hit, intersector, {stats.model, stats.termination, stats.threads, count, occlusion.get()});
  stats.rays = rendering.rays;
  stats.depth = rendering.depth;
  stats.totals = rendering.totals;
  return to_picture(rendering.image);
}

ExitCode make_image(const ImageOptions& options, std::ostream& messages) {
  ImageStats stats = chosen_stats(options);
  const std::optional<Size> size = chosen_size(options.size);
  AtomicFile out(options.out);
  std::optional<AtomicFile> stats_file;
  if (!options.stats.empty()) stats_file.emplace(options.stats);
  const Scene scene = load_scene(options.scene);
  look_at(scene, size, stats);

  const auto structure = stats.technique.structure->build(scene, stats.technique.params, stats.threads);
  const auto intersector = structure->intersector({stats.isa, stats.packet, stats.technique.params});
  Picture picture;
  if (options.heatmap.empty() || stats_file) picture = rendered(scene, *intersector, stats_file.has_value(), stats);
  if (!options.heatmap.empty()) picture = heat_map(options.heatmap, *intersector, stats);
  out.write(png_bytes(picture));
  if (stats_file) {
    stats.choice = choices(*intersector);
    if (stats.threads == 0) stats.threads = all_threads();
    stats_file->write(image_stats_json(stats));
    stats_file->commit();
  }
  out.commit();
  if (stats.heatmap) {
    const auto& [event, most, mean] = *stats.heatmap;
    messages << fmt::format("{}: {} of each eye ray, 0 (violet) to {} (yellow), mean {:.2f}\n", options.out, event, most, mean);
  }
  return ExitCode::success;
}

}  // namespace

void add_image(Cli& cli) {
  auto options = std::make_shared<ImageOptions>();
  CLI::App& command = cli.add_command("image", "raymeter image --scene spd:balls --technique bvh --out balls.png",
                                      "Renders a scene: Whitted's shading, mirrors, glass and shadows; or what it costs, as a heat map.");
  command.add_option("--scene", options->scene, "Generator (spd:balls:4) or file")->required();
  command.add_option("--technique", options->technique, "STRUCTURE[:key=value,...][+FIRST_HIT...][+OCCLUSION...], see 'raymeter list techniques'")->required();
  command.add_option("--out", options->out, "Where the PNG goes")->required();
  command.add_option("--size", options->size, "W or WxH in pixels; default: the scene's own");
  command.add_option("--depth", options->termination.max_depth, "Greatest depth of rays; the eye ray has 1")->check(CLI::Range(0, 100))->capture_default_str();
  command.add_option("--min-weight", options->termination.min_weight, "Follow reflections and refractions only where they count for this share of a pixel")
      ->capture_default_str();
  command.add_option("--camera", options->camera, "Where samples lie, and rules of surfaces: spd, havran (tables of the literature) or pixel (centres)")
      ->capture_default_str();
  command.add_option("--stats", options->stats, "Write ray counts, counters and times to this JSON file");
  command.add_option("--heatmap", options->heatmap, "Instead of the image, what each eye ray cost: nodes or tests")->check(CLI::IsMember({"nodes", "tests"}));
  command.add_option("--isa", options->isa, "Instruction set; default: the machine's best");
  command.add_option("--packet", options->packet, "Rays per packet")->check(CLI::Range(1, kMaxPacket))->capture_default_str();
  command.add_option("--threads", options->threads, "Number of threads or all")->capture_default_str();
  command.callback([&cli, options] { cli.action = [&cli, options] { return make_image(*options, *cli.err); }; });
}

}  // namespace raymeter
