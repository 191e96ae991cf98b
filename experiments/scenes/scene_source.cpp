#include "experiments/scenes/scene_source.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <string>

#include <fmt/format.h>

#include "experiments/cases/hard_case.h"
#include "experiments/scenes/generators.h"
#include "experiments/scenes/scene_readers.h"

namespace raymeter {

namespace {

constexpr std::array kFormats{
    SceneFormat{".glb", "glTF 2.0, binary", read_gltf},
    SceneFormat{".gltf", "glTF 2.0, text, with data URIs or files beside it", read_gltf},
    SceneFormat{".nff", "Neutral File Format", read_nff},
    SceneFormat{".obj", "Wavefront OBJ, with materials", read_obj},
    SceneFormat{".ply", "Polygon File Format, ASCII or binary", read_ply},
    SceneFormat{".stl", "Stereolithography, ASCII or binary", read_stl},
};

std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

const SceneFormat& find_format(const std::string& path) {
  const std::string name = lower_case(without_compression(path));
  const auto* const format = std::find_if(kFormats.begin(), kFormats.end(), [&](const SceneFormat& known) { return name.ends_with(known.extension); });
  if (format == kFormats.end()) {
    std::string known;
    for (const SceneFormat& row : kFormats) known.append(known.empty() ? "" : " ").append(row.extension);
    throw Error(fmt::format("{}: unknown kind of scene; expected a file that ends in one of {} (.xz or .gz may follow), or spd:NAME, gen:NAME or hard:NAME",
                            path, known));
  }
  return *format;
}

bool is_hard_case(std::string_view spec) noexcept { return spec.starts_with("hard:"); }

}  // namespace

bool is_generated_scene(std::string_view spec) noexcept { return spec.starts_with("spd:") || spec.starts_with("gen:") || is_hard_case(spec); }

std::span<const SceneFormat> scene_formats() noexcept { return kFormats; }

void check_scene(std::string_view spec) {
  if (is_hard_case(spec)) return (void)hard_case(spec);
  if (is_generated_scene(spec)) return check_generator_spec(spec);
  const std::string path(spec);
  (void)find_format(path);
  if (!std::filesystem::is_regular_file(path) || !std::ifstream(path)) throw Error(path + ": cannot be opened");
}

Scene load_scene(std::string_view spec) {
  if (is_hard_case(spec)) {
    Scene scene = hard_case(spec).make(0, 0).scene;
    scene.name = spec;
    return scene;
  }
  if (is_generated_scene(spec)) return generate_scene(spec);
  const std::string path(spec);
  Scene scene = find_format(path).read(read_source_file(path));
  scene.name = spec;
  scene.finish();
  return scene;
}

}  // namespace raymeter
