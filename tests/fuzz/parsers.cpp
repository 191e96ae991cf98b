#include "tests/fuzz/parsers.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "core/base/error.h"
#include "experiments/config/config.h"
#include "experiments/config/expand.h"
#include "experiments/npy.h"
#include "experiments/scenes/obj_materials.h"
#include "experiments/scenes/scene_readers.h"

namespace raymeter {

namespace {

template <class Parse>
void parse_or_refuse(const Parse& parse) {
  try {
    parse();
  } catch (const Error& error) {
    if (std::string_view(error.what()).find('\n') != std::string_view::npos) throw std::logic_error("a message of more than one line");
  }
}

template <Scene (*read)(const SourceFile&)>
void parse_scene(std::string_view bytes) {
  parse_or_refuse([&] {
    Scene scene = read({"fuzzed", std::string(bytes), std::nullopt});
    scene.finish();
    (void)scene.hash();
    if (scene.lights.empty() || scene.object_count() > scene.prim_id_count()) throw std::logic_error("a scene that contradicts itself");
  });
}

void parse_npy(std::string_view bytes) {
  parse_or_refuse([&] { (void)parse_rays_npy(bytes, "fuzzed"); });
}

void parse_mtl(std::string_view bytes) {
  parse_or_refuse([&] { (void)read_mtl({"fuzzed", std::string(bytes), std::nullopt}); });
}

void parse_experiment(std::string_view bytes) {
  parse_or_refuse([&] {
    const Config config = parse_config(bytes, "fuzzed", {}, [](const std::string&) -> const char* { return nullptr; });
    if (cell_count(config) < 1000) (void)expand(config);  // larger ones are only slow
  });
}

constexpr std::array kParsers{
    FuzzedParser{"config", parse_experiment},
    FuzzedParser{"gltf", parse_scene<read_gltf>},
    FuzzedParser{"mtl", parse_mtl},
    FuzzedParser{"nff", parse_scene<read_nff>},
    FuzzedParser{"npy", parse_npy},
    FuzzedParser{"obj", parse_scene<read_obj>},
    FuzzedParser{"ply", parse_scene<read_ply>},
    FuzzedParser{"stl", parse_scene<read_stl>},
};

}  // namespace

std::span<const FuzzedParser> fuzzed_parsers() noexcept { return kParsers; }

int fuzz(std::string_view parser, std::string_view bytes) {
  std::find_if(kParsers.begin(), kParsers.end(), [&](const FuzzedParser& row) { return row.name == parser; })->parse(bytes);
  return 0;
}

}  // namespace raymeter
