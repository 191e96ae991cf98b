#include "tests/support/test_scenes.h"

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "experiments/scenes/generators.h"
#include "tests/support/random.h"

namespace raymeter::test {

namespace {

void add_polygon(Scene& scene, const glm::dvec3& center, const glm::dvec3& x, const glm::dvec3& y, int corners, double notch) {
  std::vector<glm::dvec3> vertices;
  for (int k = 0; k < corners; ++k) {
    const double angle = 2 * std::numbers::pi * k / corners, r = k % 2 == 0 ? 1 : notch;
    vertices.push_back(center + r * (std::cos(angle) * x + std::sin(angle) * y));
  }
  scene.add_polygon(vertices);
}

/// All kinds in a cube, scaled and moved.
Scene mixed(int count, double size, double scale = 1, const glm::dvec3& offset = glm::dvec3(0.0)) {
  Random random(11);
  Scene scene;
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 p = offset + scale * random.in_cube(), e = scale * size * random.direction(), f = scale * size * random.direction();
    switch (i % 5) {
      case 0: scene.add_triangle(p, p + e, p + f); break;
      case 1: scene.add_sphere(p, scale * size * random.uniform(0.1, 0.7)); break;
      case 2: scene.add_cone(p, scale * size * random.uniform(0, 0.5), p + e, scale * size * random.uniform(0, 0.5)); break;
      case 3: add_polygon(scene, p, e, f, 7, 0.5); break;
      default: scene.add_cone(p, scale * size * 0.2, p + e, scale * size * 0.2);
    }
  }
  return scene;
}

Scene single(PrimKind kind) {
  Scene scene;
  switch (kind) {
    case PrimKind::sphere: scene.add_sphere({0, 0, 0}, 1); break;
    case PrimKind::triangle: scene.add_triangle({-1, -1, 0}, {1, -1, 0.5}, {0, 1, 0}); break;
    case PrimKind::polygon: add_polygon(scene, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 6, 1); break;
    case PrimKind::cone: scene.add_cone({0, -1, 0}, 1, {0, 1, 0}, 0.25); break;
  }
  return scene;
}

Scene coincident(PrimKind kind, int count) {
  Scene scene;
  for (int i = 0; i < count; ++i) {
    if (kind == PrimKind::sphere)
      scene.add_sphere({0.25, 0.5, 0.75}, 1);
    else
      scene.add_triangle({0, 0, 0}, {1, 0, 0.25}, {0, 1, 0});
  }
  return scene;
}

Scene concentric() {
  Scene scene;
  for (int i = 64; i > 0; --i) scene.add_sphere({0, 0, 0}, i / 16.0);
  return scene;
}

/// Everything in the plane y = 0, overlapping: ties and boxes without height.
Scene flat() {
  Scene scene;
  Random random(12);
  for (int i = 0; i < 120; ++i) {
    const auto corner = [&] { return glm::dvec3(std::round(random.uniform(-8, 8)) / 4, 0, std::round(random.uniform(-8, 8)) / 4); };
    if (i % 3 == 0)
      add_polygon(scene, corner(), {0.5, 0, 0}, {0, 0, 0.5}, 8, 0.5);
    else
      scene.add_triangle(corner(), corner(), corner());
  }
  return scene;
}

/// A floor of 1e4 and a needle through everything, among primitives of 1e-2.
Scene huge_among_tiny() {
  Scene scene = mixed(150, 0.01, 1, {3, 0.5, -2});
  scene.add_triangle({-1e4, 0, -1e4}, {1e4, 0, -1e4}, {0, 0, 2e4});
  scene.add_triangle({2, 0.5, -1e5}, {2.5, 0.5, 1e5}, {2.5, 0.51, 1e5});
  scene.add_sphere({0, -1e6, 0}, 1e6);
  scene.add_cone({3, -50, -2}, 0.001, {3, 50, -2}, 0.002);
  return scene;
}

Scene polygons() {
  Scene scene;
  Random random(13);
  for (int i = 0; i < 30; ++i) {
    const glm::dvec3 x = random.direction(), y = glm::normalize(glm::cross(x, random.direction()));
    add_polygon(scene, 2.0 * random.in_cube(), x, y, i % 2 == 0 ? 144 : 9 + i, i % 3 == 0 ? 1 : 0.3);
  }
  return scene;
}

Scene cones() {
  Scene scene;
  Random random(14);
  for (int i = 0; i < 90; ++i) {
    const glm::dvec3 base = random.in_cube();
    const double r = random.uniform(0.001, 0.2);
    const glm::dvec3 axis = i % 4 == 0 ? glm::dvec3(0, 0.5, 0) : random.uniform(0.05, 1) * random.direction();
    scene.add_cone(base, r, base + axis, i % 3 == 0 ? r : i % 3 == 1 ? 0 : r / 2);
  }
  return scene;
}

/// A square cut into 64 triangles about its centre, twice.
Scene fan() {
  Scene scene;
  for (int i = 0; i < 128; ++i) {
    const double a = 2 * std::numbers::pi * i / 64, b = 2 * std::numbers::pi * ((i + 1) % 64) / 64;
    scene.add_triangle({0, 0, 0}, {std::cos(a), std::sin(a), 0}, {std::cos(b), std::sin(b), 0});
  }
  return scene;
}

/// Every second primitive is dropped.
Scene with_dropped() {
  Scene scene;
  Random random(15);
  for (int i = 0; i < 60; ++i) {
    const glm::dvec3 p = random.in_cube();
    if (i % 2 == 0)
      scene.add_triangle(p, p + 0.5 * random.direction(), p + 0.5 * random.direction());
    else if (i % 4 == 1)
      scene.add_sphere(p, -1);
    else
      scene.add_triangle(p, p, {0, std::numeric_limits<double>::quiet_NaN(), 0});
  }
  return scene;
}

/// The generator's smallest scene of at least 50 primitives, unless that is a big one.
void add_generated(const SceneGenerator& generator, std::vector<Scene>& scenes) {
  for (int size = generator.min_size; size <= generator.default_size; size = std::max(size + 1, size * 4 / 3)) {
    Scene scene = generator.make(size);
    if (scene.prim_count() < 50) continue;
    if (scene.prim_count() > 1000) return;
    scene.name = std::string(generator.spec_prefix) + ":" + std::to_string(size);
    scenes.push_back(std::move(scene));
    return;
  }
}

}  // namespace

Scene icosphere(int level, double radius, const glm::dvec3& center) {
  const double g = std::numbers::phi;
  std::vector<glm::dvec3> vertices{{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  std::vector<std::array<std::size_t, 3>> faces{{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                                                {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                                                {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int step = 0; step < level; ++step) {
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> middles;
    const auto middle = [&](std::size_t a, std::size_t b) {
      const auto [at, is_new] = middles.try_emplace(std::minmax({a, b}), vertices.size());
      if (is_new) vertices.push_back(vertices[a] + vertices[b]);
      return at->second;
    };
    std::vector<std::array<std::size_t, 3>> finer;
    for (const auto& [a, b, c] : faces) {
      const std::size_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const auto& face : {std::array{a, ab, ca}, std::array{ab, b, bc}, std::array{ca, bc, c}, std::array{ab, bc, ca}}) finer.push_back(face);
    }
    faces = std::move(finer);
    for (glm::dvec3& v : vertices) v = glm::normalize(v);
  }
  Scene scene;
  const auto at = [&](std::size_t i) { return center + radius * glm::normalize(vertices[i]); };
  for (const auto& [a, b, c] : faces) scene.add_triangle(at(a), at(b), at(c));
  scene.name = "icosphere " + std::to_string(level);
  scene.finish();
  return scene;
}

std::vector<Scene> hard_scenes() {
  const glm::dvec3 far_away(148376, 1234, -223423);
  std::vector<Scene> scenes;
  const auto add = [&](std::string name, Scene scene) {
    scene.name = std::move(name);
    scene.finish();
    scenes.push_back(std::move(scene));
  };
  add("empty", Scene());
  add("one sphere", single(PrimKind::sphere));
  add("one triangle", single(PrimKind::triangle));
  add("one polygon", single(PrimKind::polygon));
  add("one cone", single(PrimKind::cone));
  add("coincident spheres", coincident(PrimKind::sphere, 1000));
  add("coincident triangles", coincident(PrimKind::triangle, 1000));
  add("concentric spheres", concentric());
  add("mixed", mixed(200, 0.3));
  add("mixed tiny", mixed(100, 0.3, 1e-6));
  add("mixed large", mixed(100, 0.3, 1e6));
  add("mixed far away", mixed(100, 0.3, 2, far_away));
  add("flat", flat());
  add("huge among tiny", huge_among_tiny());
  add("icosphere", icosphere(2));
  add("icosphere far away", icosphere(2, 2, far_away));
  add("polygons", polygons());
  add("cones", cones());
  add("fan", fan());
  add("dropped", with_dropped());
  for (const SceneGenerator& generator : scene_generators()) add_generated(generator, scenes);
  return scenes;
}

}  // namespace raymeter::test
