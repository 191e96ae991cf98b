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
    // Standard Procedural Databases
    SceneGenerator{"spd:balls", "sphere flake on a floor: clusters of ever smaller mirror spheres at even density; reflection", "recursion depth", 4, 0, 8,
                   make_balls},
    SceneGenerator{"spd:gears", "meshed gears, every fifth of glass: concave 144-gons and thin quads in groups; refraction, 5 lights", "gears a side", 4, 1, 64,
                   make_gears},
    SceneGenerator{"spd:mount", "fractal mountain under 4 glass balls: a triangle mesh of even size; deep refraction trees", "subdivision level", 6, 1, 12,
                   make_mount},
    SceneGenerator{"spd:rings", "pyramid of interlocked rings: cylinders and spheres at all angles that fill their boxes badly; 3 lights", "layers", 7, 1, 100,
                   make_rings},
    SceneGenerator{"spd:teapot", "teapot on a chequered board: smooth mesh of small triangles on few large quads (statistics in the literature use size 12)",
                   "divisions of a patch", 6, 1, 500, make_teapot},
    SceneGenerator{"spd:tetra", "Sierpinski tetrahedron: triangles with gaps of all sizes; most rays miss, or nearly miss much", "recursion depth", 6, 1, 12,
                   make_tetra},
    SceneGenerator{"spd:tree", "branching tree on a huge field: dense tiny cones and spheres in a large empty space; 7 lights", "recursion depth", 11, 0, 23,
                   make_tree},
    SceneGenerator{"spd:lattice", "even lattice of balls and axis-parallel rods: the best case of grids, seen from inside; 6 lights", "cells a side", 12, 1,
                   160, make_lattice},
    SceneGenerator{"spd:shells", "sea shell of nested, heavily overlapping spheres: the worst case of spatial subdivision", "doublings of 180 spheres", 5, 0,
                   17, make_shells},
    SceneGenerator{"spd:jacks", "jacks within jacks: crossing rods and balls in small groups, at all scales in one place", "recursion depth", 1, 1, 8,
                   make_jacks},
    SceneGenerator{"spd:sombrero", "wave surface: a regular height field of triangles, one light", "doublings of 16 samples a side", 1, 1, 8, make_sombrero},
};

const SceneGenerator& find_generator(std::string_view spec, std::string_view prefix) {
  std::vector<std::string_view> known;
  for (const SceneGenerator& generator : kGenerators) {
    if (generator.spec_prefix == prefix) return generator;
    known.push_back(generator.spec_prefix);
  }
  std::string expected = nearest_word(prefix, known);
  if (!expected.empty())
    expected = "did you mean " + expected + "?";
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
