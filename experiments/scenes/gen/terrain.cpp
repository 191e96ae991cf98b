#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/base/random.h"
#include "experiments/scenes/gen/gen_scene.h"

namespace raymeter {

namespace {

constexpr int kCoarsest = 3;                  // lattice cells a side in octave 0
constexpr double kRelief = 0.25;              // amplitude of octave 0
constexpr double kGain = 0.5743491774985175;  // 2^-0.8: a surface of dimension 2.2, that of SPD's mountain

double lattice_value(int octave, int x, int y) noexcept {
  constexpr std::uint64_t kSeed = 20;
  const auto key = static_cast<std::uint64_t>(octave) << 56 | static_cast<std::uint64_t>(x) << 28 | static_cast<std::uint64_t>(y);
  return 2 * RandomStream(kSeed, key).uniform() - 1;
}

/// A position among lattice points: the one before it, and how far it is on to the next, eased so that slopes meet.
struct LatticePosition {
  explicit LatticePosition(double x) noexcept : before(static_cast<int>(x)), on(x - before) { on = on * on * (3 - 2 * on); }
  int before;
  double on;
};

/// Fractal value noise on rows of a grid over the unit square: octave k joins random values at 3 2^k points a side, 2^(-0.8 k) as high as octave 0.
class FractalNoise {
public:
  /// As many octaves as have two grid cells or more to a lattice cell, and at least one.
  explicit FractalNoise(int grid_cells) : grid_cells_(grid_cells) {
    while (kCoarsest << octaves_ <= grid_cells / 2) ++octaves_;
  }

  /// The heights along the row at `y`, from x = 0 to 1.
  [[nodiscard]] std::vector<double> row(double y) const {
    std::vector<double> heights(static_cast<std::size_t>(grid_cells_) + 1, 0.0);
    double amplitude = kRelief;
    for (int octave = 0; octave < octaves_; ++octave, amplitude *= kGain) add_octave(heights, octave, amplitude, y);
    return heights;
  }

private:
  void add_octave(std::vector<double>& heights, int octave, double amplitude, double y) const {
    const int cells = kCoarsest << octave;
    const LatticePosition across(cells * y);
    std::vector<double> lattice;  // interpolated across, so that only the way along the row is left
    for (int x = 0; x <= cells + 1; ++x)
      lattice.push_back(std::lerp(lattice_value(octave, x, across.before), lattice_value(octave, x, across.before + 1), across.on));
    for (std::size_t i = 0; i < heights.size(); ++i) {
      const LatticePosition along(cells * (static_cast<double>(i) / grid_cells_));
      const auto before = static_cast<std::size_t>(along.before);
      heights[i] += amplitude * std::lerp(lattice[before], lattice[before + 1], along.on);
    }
  }

  int grid_cells_;
  int octaves_ = 1;
};

}  // namespace

// A height field over [-1, 1]^2. The mountains are a function of the place, not of the size: a larger size shows the same ones in more detail.
Scene make_terrain(int triangles) {
  Scene scene = gen_scene({-0.8, -0.95, 0.7}, {0.15, 0.2, -0.1}, {0, 0, 1}, 45, {-6, 2, 5});
  const int cells = std::max(1, static_cast<int>(std::lround(std::sqrt(triangles / 2.0))));  // on a side
  const auto n = static_cast<std::size_t>(cells);
  const FractalNoise noise(cells);
  scene.reserve(PrimKind::triangle, 2 * n * n);
  scene.set_material({.color = {0.5, 0.45, 0.35}, .diffuse = 1});
  std::vector<glm::dvec3> row(n + 1), next(n + 1);
  const auto fill = [&](std::vector<glm::dvec3>& points, std::size_t j) {
    const double y = static_cast<double>(j) / cells;
    const std::vector<double> heights = noise.row(y);
    for (std::size_t i = 0; i <= n; ++i) points[i] = {2 * (static_cast<double>(i) / cells) - 1, 2 * y - 1, heights[i]};
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
