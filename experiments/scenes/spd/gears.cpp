#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "experiments/scenes/spd/spd_scene.h"

namespace raymeter {

namespace {

constexpr int kTeeth = 36;
constexpr std::size_t kCorners = 4 * kTeeth;
using Outline = std::array<glm::dvec3, kCorners>;

/// The outline of a gear at height z, counterclockwise from above where `sense` is 1, clockwise where it is -1; either way it begins with the same tooth.
Outline outline(const glm::dvec3& center, double radius, double phase, int sense) {
  const double outer = 0.995 * radius, inner = 0.9 * radius;
  const double pitch = sense * 2 * std::numbers::pi / kTeeth;
  Outline points;
  for (std::size_t tooth = 0; tooth < kTeeth; ++tooth) {
    const double angle = phase + static_cast<double>(tooth) * pitch;
    const auto at = [&](double r, double shift) { return center + r * glm::dvec3(std::cos(angle + shift * pitch), std::sin(angle + shift * pitch), 0); };
    points[4 * tooth] = at(outer, -0.19);
    points[4 * tooth + 1] = at(outer, 0.19);
    points[4 * tooth + 2] = at(inner, 0.3);
    points[4 * tooth + 3] = at(inner, 0.7);
  }
  return points;
}

/// The n - 2 triangles of an outline: two a tooth, and a fan over the convex rest.
void add_split(Scene& scene, const Outline& points) {
  for (std::size_t tooth = 0; tooth < kTeeth; ++tooth) {
    const glm::dvec3& before = points[(4 * tooth + kCorners - 1) % kCorners];
    scene.add_triangle(before, points[4 * tooth], points[4 * tooth + 1]);
    scene.add_triangle(before, points[4 * tooth + 1], points[4 * tooth + 2]);
  }
  for (std::size_t corner = 1; corner + 1 < kCorners / 2; ++corner) {
    const auto inner = [&](std::size_t i) { return points[4 * (i / 2) + 2 + i % 2]; };
    scene.add_triangle(inner(0), inner(corner), inner(corner + 1));
  }
}

enum class Faces { whole, split };

void add_gear(Scene& scene, const glm::dvec3& top_center, double radius, double thickness, double phase, Faces faces) {
  const Outline top = outline(top_center, radius, phase, 1);
  const glm::dvec3 down(0, 0, -thickness);
  const auto add_face = [&](const Outline& points) { faces == Faces::whole ? scene.add_polygon(points) : add_split(scene, points); };
  add_face(top);
  for (std::size_t i = 0; i < kCorners; ++i) {
    const glm::dvec3 &here = top[i], &next = top[(i + 1) % kCorners];
    const std::array<glm::dvec3, 4> side{here, here + down, next + down, next};
    scene.add_polygon(side);
  }
  add_face(outline(top_center + down, radius, phase, -1));
}

/// A bright colour for each place; every fifth diagonal plane of gears is glass.
Material gear_material(int x, int y, int z) {
  const auto sevenths = [](int n) { return 0.01 + n % 7 / 7.0; };
  Material material{.color = {sevenths(5 * (3 * x + 2 * y + z + 1)), sevenths(3 * (3 * y + 2 * z + x + 1)), sevenths(2 * (3 * z + 2 * x + y + 1))},
                    .diffuse = 1,
                    .specular = 0,
                    .shine = kNoHighlight,
                    .ior = 0};
  material.color /= std::max({material.color.r, material.color.g, material.color.b});
  if ((4 * x + 2 * y + z) % 5 == 0) {
    material.diffuse = 0.2;
    material.transmittance = 0.8;
    material.ior = 1.1;
  }
  return material;
}

Scene make(int size, Faces faces) {
  Scene scene = spd_scene({-1.1, -2.1, 2.6}, {0, 0, 0}, {0, 0, 1}, 1, {{2, 4, 4}, {-2, 4, 3}, {2, -2.5, 2.5}, {-1, -4, 2}, {-1.111, -2.121, 2.626}});
  scene.set_material({.color = {1, 0.85, 0.7}, .diffuse = 0.3, .specular = 0.6, .shine = phong_power(37), .ior = 0});
  const std::array<glm::dvec3, 4> ground{{{2, 2, 0}, {-2, 2, 0}, {-2, -2, 0}, {2, -2, 0}}};
  scene.add_polygon(ground);
  const double radius = 1 / (size - (size - 1) * 0.05);
  const double thickness = std::min(0.1, 1 / (2.0 * size));
  for (int z = 0; z < size; ++z) {
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        const glm::dvec3 top_center(-1 + radius + x * 1.9 * radius, -1 + radius + y * 1.9 * radius, 1 - static_cast<double>(z) / size);
        scene.set_material(gear_material(x, y, z));
        scene.begin_object("gear");
        // Neighbours mesh: every other gear is turned by half a tooth.
        add_gear(scene, top_center, radius, thickness, std::numbers::pi * ((x + y + z) % 2) / kTeeth, faces);
        scene.end_object();
      }
    }
  }
  return scene;
}

}  // namespace

Scene make_gears(int size) { return make(size, Faces::whole); }

Scene make_split_gears(int size) { return make(size, Faces::split); }

}  // namespace raymeter
