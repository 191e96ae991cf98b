#include "experiments/scenes/generators.h"

#include <array>
#include <charconv>
#include <string>
#include <vector>

#include "accel/params.h"
#include "core/base/error.h"
#include "experiments/scenes/spd/spd_scene.h"

namespace raymeter {

namespace {

constexpr std::array kGenerators{
    SceneGenerator{"spd:balls", "sphere flake on a floor: spheres of all sizes, touching and nested in density, with mirror reflections", "recursion depth", 4, 0, 8,
                   make_balls},
};

const SceneGenerator& find_generator(std::string_view spec, std::string_view prefix) {
  std::vector<std::string_view> known;
  for (const SceneGenerator& generator : kGenerators) {
    if (generator.spec_prefix == prefix) return generator;
    known.push_back(generator.spec_prefix);
  }
  std::string expected = nearest_word(prefix, known);
  if (!expected.empty()) expected = "did you mean " + expected + "?";
  else
    for (const std::string_view name : known) expected += (expected.empty() ? "expected one of " : ", ") + std::string(name);
  throw Error(std::string(spec) + ": unknown generator '" + std::string(prefix) + "'; " + expected);
}

int parse_size(const SceneGenerator& generator, std::string_view spec, std::string_view text) {
  int size = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), size);
  const bool whole = error == std::errc{} && end == text.data() + text.size();
  if (whole && size >= generator.min_size && size <= generator.max_size) return size;
  throw Error(std::string(spec) + ": expected a size (" + std::string(generator.size_means) + ") from " + std::to_string(generator.min_size) + " to " +
              std::to_string(generator.max_size) + ", got '" + std::string(text) + "'");
}

}  // namespace

std::span<const SceneGenerator> scene_generators() noexcept { return kGenerators; }

Scene generate_scene(std::string_view spec) {
  // The prefix has one colon itself; the size follows a second.
  const std::size_t first = spec.find(':');
  const std::size_t second = first == std::string_view::npos ? first : spec.find(':', first + 1);
  const SceneGenerator& generator = find_generator(spec, spec.substr(0, second));
  const int size = second == std::string_view::npos ? generator.default_size : parse_size(generator, spec, spec.substr(second + 1));
  Scene scene = generator.make(size);
  scene.name = spec;
  scene.finish();
  return scene;
}

}  // namespace raymeter
