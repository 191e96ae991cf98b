#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/random.h"
#include "experiments/scenes/gen/gen_scene.h"

namespace raymeter {

namespace {

double lattice_value(int octave, std::int64_t x, std::int64_t y) noexcept {
  constexpr std::uint64_t kSeed = 20;
  const auto key = static_cast<std::uint64_t>(octave) << 56 | static_cast<std::uint64_t>(x) << 28 | static_cast<std::uint64_t>(y);
  return 2 * RandomStream(kSeed, key).uniform() - 1;
}

/// Random values at the integers, joined smoothly.
double noise(int octave, double x, double y) noexcept {
  const double cell_x = std::floor(x), cell_y = std::floor(y);
  const auto i = static_cast<std::int64_t>(cell_x), j = static_cast<std::int64_t>(cell_y);
  const auto ease = [](double t) { return t * t * (3 - 2 * t); };
  const double u = ease(x - cell_x), v = ease(y - cell_y);
  const double lower = std::lerp(lattice_value(octave, i, j), lattice_value(octave, i + 1, j), u);
  const double upper = std::lerp(lattice_value(octave, i, j + 1), lattice_value(octave, i + 1, j + 1), u);
  return std::lerp(lower, upper, v);
}

/// Fractal noise of dimension 2.2, that of SPD's mountain: each octave is twice as fine and 2^-0.8 as high. `x` and `y` are in [0, 1].
double height(double x, double y, int octaves) noexcept {
  double sum = 0, amplitude = 0.25, frequency = 3;
  for (int octave = 0; octave < octaves; ++octave) {
    sum += amplitude * noise(octave, frequency * x, frequency * y);
    amplitude *= 0.5743491774985175;
    frequency *= 2;
  }
  return sum;
}

}  // namespace

// A height field over [-1, 1]^2. It is a function of the place, not of the size: a larger size shows the same mountains in more detail.
Scene make_terrain(int triangles) {
  Scene scene = gen_scene({-0.9, -1.7, 0.9}, {0.05, 0, -0.15}, {0, 0, 1}, 45, {-6, -3, 5});
  const int cells = std::max(1, static_cast<int>(std::lround(std::sqrt(triangles / 2.0))));  // on a side
  const auto n = static_cast<std::size_t>(cells);
  int octaves = 1;  // the finest has two cells to its lattice distance, but for the coarsest grids
  while (3 << octaves <= cells / 2) ++octaves;
  scene.reserve(PrimKind::triangle, 2 * n * n);
  scene.set_material({.color = {0.5, 0.45, 0.35}, .diffuse = 1});
  std::vector<glm::dvec3> row(n + 1), next(n + 1);
  const auto fill = [&](std::vector<glm::dvec3>& points, std::size_t j) {
    const double y = static_cast<double>(j) / cells;
    for (std::size_t i = 0; i <= n; ++i) {
      const double x = static_cast<double>(i) / cells;
      points[i] = {2 * x - 1, 2 * y - 1, height(x, y, octaves)};
    }
  };
  scene.begin_object("terrain");
  fill(row, 0);
  for (std::size_t j = 1; j <= n; ++j) {
    fill(next, j);
    for (std::size_t i = 1; i <= n; ++i) {
      scene.add_triangle(row[i - 1], row[i], next[i]);
      scene.add_triangle(next[i], next[i - 1], row[i - 1]);
    }
    row.swap(next);
  }
  scene.end_object();
  return scene;
}

}  // namespace raymeter
