#include <array>
#include <cmath>
#include <numbers>

#include <glm/trigonometric.hpp>

#include "experiments/scenes/spd/spd_scene.h"

namespace raymeter {

namespace {

/// A normally distributed number of a seed: two steps of a linear congruential generator a try, by Marsaglia's polar method.
double gauss(int seed) noexcept {
  constexpr int kFactor = 8121, kIncrement = 28411, kModulus = 134456;
  double u, r;
  do {
    const int first = (kIncrement + kFactor * seed) % kModulus;
    seed = (kIncrement + kFactor * first) % kModulus;
    u = 2.0 * first / kModulus - 1;
    const double v = 2.0 * seed / kModulus - 1;
    r = u * u + v * v;
  } while (r >= 1);
  return u * std::sqrt(-2 * std::log(r) / r);
}

/// Fractal terrain over the square [-1, 1]^2, by random displacement of the midpoints of edges and quads.
class Terrain {
public:
  Terrain(Scene& scene, int size) : scene_(scene), size_(size), cells_(1 << size) {
    constexpr double kDimension = 2.2;
    const double q = 2 / std::exp2(1 / (kDimension - 1));
    roughness_ = std::sqrt(q * q - 1);
  }

  void add() { add_quad(0, 0, cells_, {0, 0, 0, 0}); }

private:
  struct Heights {
    double lower_left, lower_right, upper_right, upper_left;
  };

  /// The hash of the pictures of 1987, which uses the bits of x twice.
  [[nodiscard]] double displacement(int x, int y) const noexcept {
    const int low = size_ <= 7 ? x << (7 - size_) : 0;
    return gauss(21 + ((x << (23 - size_)) + (y << (15 - size_)) + low) % 65536);
  }

  void add_quad(int x, int y, int width, const Heights& z) {
    if (width == 1) return add_cell(x, y, z);
    const int half = width / 2;
    const double amplitude = half * 2.0 / cells_ * roughness_;
    const double lower = (z.lower_left + z.lower_right) / 2 + amplitude * displacement(x + half, y);
    const double right = (z.lower_right + z.upper_right) / 2 + amplitude * displacement(x + width, y + half);
    const double upper = (z.upper_right + z.upper_left) / 2 + amplitude * displacement(x + half, y + width);
    const double left = (z.upper_left + z.lower_left) / 2 + amplitude * displacement(x, y + half);
    const double middle = (z.lower_left + z.lower_right + z.upper_right + z.upper_left) / 4 + 1.4142136 * amplitude * displacement(x + half, y + half);
    add_quad(x, y, half, {z.lower_left, lower, middle, left});
    add_quad(x + half, y, half, {lower, z.lower_right, right, middle});
    add_quad(x + half, y + half, half, {middle, right, z.upper_right, upper});
    add_quad(x, y + half, half, {left, middle, upper, z.upper_left});
  }

  void add_cell(int x, int y, const Heights& z) {
    const auto at = [&](int column, int row, double height) { return glm::dvec3(-1 + 2.0 * column / cells_, -1 + 2.0 * row / cells_, height); };
    const glm::dvec3 lower_left = at(x, y, z.lower_left), upper_right = at(x + 1, y + 1, z.upper_right);
    scene_.add_triangle(lower_left, at(x + 1, y, z.lower_right), upper_right);
    scene_.add_triangle(upper_right, at(x, y + 1, z.upper_left), lower_left);
  }

  Scene& scene_;
  int size_;
  int cells_;  ///< on a side
  double roughness_;
};

}  // namespace

Scene make_mount(int size) {
  Scene scene = spd_scene({-1.6, 1.6, 1.7}, {0, 0, 0}, {0, 0, 1}, 0.01, {{-100, -100, 100}});
  scene.reserve(PrimKind::triangle, std::size_t{2} << (2 * size));
  scene.set_material({.color = {1, 1, 1}, .diffuse = 0.1, .specular = 0.1, .shine = phong_power(6.7), .transmittance = 0.9, .ior = 1.5});
  const glm::dvec3 center(-0.8, 0.8, 1);
  const double radius = 0.17;
  const glm::dvec3 top(0, 0, radius * std::sqrt(1.5));
  scene.add_sphere(center + top, radius);
  const glm::dvec3 side = rotation(std::acos(-1 / 3.0), {1, 1, 0}) * top;
  for (const double degrees : {0.0, 120.0, 240.0}) scene.add_sphere(center + rotation(glm::radians(degrees), {0, 0, 1}) * side, radius);
  scene.set_material({.color = {0.5, 0.45, 0.35}, .diffuse = 1, .specular = 0, .shine = kNoHighlight, .ior = 0});
  scene.begin_object("terrain");
  Terrain(scene, size).add();
  scene.end_object();
  return scene;
}

}  // namespace raymeter
