#include "experiments/scenes/generators.h"

#include <array>
#include <charconv>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "accel/params.h"
#include "core/base/error.h"
#include "experiments/scenes/gen/gen_scene.h"
#include "experiments/scenes/spd/spd_scene.h"

namespace raymeter {

namespace {

constexpr std::array kGenerators{
    // Standard Procedural Databases
    SceneGenerator{"spd:balls", "sphere flake on a floor: clusters of ever smaller mirrors; spheres, reflection", "recursion depth", 4, 0, 8, make_balls},
    SceneGenerator{"spd:gears", "meshed gears, every fifth of glass: 144-gons and thin quads, in groups; refraction, 5 lights", "number of gears a side", 4, 1,
                   64, make_gears},
    SceneGenerator{"spd:mount", "fractal mountain under four glass balls: a triangle mesh; rays that split again and again", "subdivision level", 6, 1, 12,
                   make_mount},
    SceneGenerator{"spd:rings", "pyramid of interlocked rings: tubes at all angles, which fill their boxes badly; 3 lights", "number of layers", 7, 1, 100,
                   make_rings},
    SceneGenerator{"spd:teapot", "teapot on a chequered board: a smooth mesh beside large squares; the literature's statistics use size 12",
                   "number of divisions of a patch", 6, 1, 500, make_teapot},
    SceneGenerator{"spd:tetra", "Sierpinski tetrahedron: triangles round gaps of all sizes; most rays miss, many only just", "recursion depth", 6, 1, 12,
                   make_tetra},
    SceneGenerator{"spd:tree", "leafless tree on a wide field: dense small cones and spheres in a large empty space; 7 lights", "recursion depth", 11, 0, 23,
                   make_tree},
    SceneGenerator{"spd:lattice", "even lattice of balls and axis-parallel rods, seen from inside: the best case of grids; 6 lights", "number of cells a side",
                   12, 1, 160, make_lattice},
    SceneGenerator{"spd:shells", "sea shell of spheres that overlap heavily: the worst case of spatial subdivision", "number of doublings of 180 spheres", 5, 0,
                   17, make_shells},
    SceneGenerator{"spd:jacks", "jacks round jacks: crossing rods and balls of all scales in one place, in groups of nine", "recursion depth", 1, 1, 8,
                   make_jacks},
    SceneGenerator{"spd:sombrero", "rippled surface: a regular height field of triangles", "number of doublings of 16 samples a side", 1, 1, 8, make_sombrero},
    // Our own
    SceneGenerator{"gen:split_gears", "spd:gears with its 144-gons split into fans of long triangles, as some programs read polygons", "number of gears a side",
                   4, 1, 64, make_split_gears},
    SceneGenerator{"gen:ear_gears", "spd:gears with its 144-gons split into compact triangles, by cutting off ears", "number of gears a side", 4, 1, 64,
                   make_ear_gears},
    SceneGenerator{"gen:rim_gears", "spd:gears with the quads of its rims split into triangles", "number of gears a side", 4, 1, 64, make_rim_gears},
    SceneGenerator{"gen:hairball", "ball of tangled hair: long thin triangles in every direction, which fill their boxes badly",
                   "number of strands of 144 triangles", 2000, 1, 300'000, make_hairball},
    SceneGenerator{"gen:stadium", "small teapot in a large stadium: all detail in one spot, the worst case of a grid", "number of divisions of a teapot patch",
                   12, 1, 500, make_stadium},
    SceneGenerator{"gen:terrain", "fractal mountains, the same ones at every size: an even mesh to scale up", "number of triangles, to the nearest 2 n^2",
                   100'000, 2, 40'000'000, make_terrain},
    SceneGenerator{"gen:cloud", "small triangles at random in a cube, one on a ray's way in the mean: no coherence to profit from", "number of triangles",
                   100'000, 1, 40'000'000, make_cloud},
    SceneGenerator{"gen:spheres", "small spheres at random in a cube, one on a ray's way in the mean", "number of spheres", 100'000, 1, 40'000'000,
                   make_spheres},
    SceneGenerator{"gen:icosphere", "closed triangle mesh of the unit sphere, its corners shared bit for bit: any hole that rays find is an error",
                   "number of subdivisions of an icosahedron", 5, 0, 10, make_icosphere},
};

const SceneGenerator& find_generator(std::string_view spec, std::string_view prefix) {
  std::vector<std::string_view> known;
  for (const SceneGenerator& generator : kGenerators) {
    if (generator.spec_prefix == prefix) return generator;
    known.push_back(generator.spec_prefix);
  }
  const std::string near = nearest_word(prefix, known);
  const std::string expected = near.empty() ? fmt::format("expected one of {}", fmt::join(known, ", ")) : fmt::format("did you mean {}?", near);
  throw Error(fmt::format("{}: unknown generator '{}'; {}", spec, prefix, expected));
}

int parse_size(const SceneGenerator& generator, std::string_view spec, std::string_view text) {
  int size = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), size);
  const bool whole = error == std::errc{} && end == text.data() + text.size();
  if (whole && size >= generator.min_size && size <= generator.max_size) return size;
  throw Error(fmt::format("{}: expected a size ({}) from {} to {}, got '{}'", spec, generator.size_means, generator.min_size, generator.max_size, text));
}

struct ParsedSpec {
  const SceneGenerator& generator;
  int size;
};

ParsedSpec parse_spec(std::string_view spec) {
  // The prefix has one colon itself; the size follows a second.
  const std::size_t first = spec.find(':');
  const std::size_t second = first == std::string_view::npos ? first : spec.find(':', first + 1);
  const SceneGenerator& generator = find_generator(spec, spec.substr(0, second));
  return {generator, second == std::string_view::npos ? generator.default_size : parse_size(generator, spec, spec.substr(second + 1))};
}

}  // namespace

std::span<const SceneGenerator> scene_generators() noexcept { return kGenerators; }

void check_generator_spec(std::string_view spec) { (void)parse_spec(spec); }

Scene generate_scene(std::string_view spec) {
  const auto [generator, size] = parse_spec(spec);
  Scene scene = generator.make(size);
  scene.name = spec;
  scene.finish();
  return scene;
}

}  // namespace raymeter
