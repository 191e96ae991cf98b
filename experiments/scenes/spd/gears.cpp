#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

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

/// What of a gear is split into triangles: nothing; its two 144-gons, by a fan of long triangles or by cutting ears, which gives compact ones; or its rim of
/// quads.
enum class Split { nothing, faces_by_fan, faces_by_ears, rim };

using Corners = std::vector<glm::dvec3>;

void add_fan(Scene& scene, const Corners& convex) {
  for (std::size_t i = 1; i + 1 < convex.size(); ++i) scene.add_triangle(convex[0], convex[i], convex[i + 1]);
}

/// Cuts off every other corner, round after round.
void add_by_ears(Scene& scene, Corners convex) {
  while (convex.size() > 3) {
    Corners left;
    for (std::size_t i = 0; i < convex.size(); i += 2) {
      left.push_back(convex[i]);
      if (i + 1 < convex.size()) scene.add_triangle(convex[i], convex[i + 1], convex[(i + 2) % convex.size()]);
    }
    convex = std::move(left);
  }
  if (convex.size() == 3) scene.add_triangle(convex[0], convex[1], convex[2]);
}

/// The n - 2 triangles of an outline: two a tooth, and those of the convex rest.
void add_split(Scene& scene, const Outline& points, Split split) {
  for (std::size_t tooth = 0; tooth < kTeeth; ++tooth) {
    const glm::dvec3& before = points[(4 * tooth + kCorners - 1) % kCorners];
    scene.add_triangle(before, points[4 * tooth], points[4 * tooth + 1]);
    scene.add_triangle(before, points[4 * tooth + 1], points[4 * tooth + 2]);
  }
  Corners rest;
  for (std::size_t i = 0; i < kCorners / 2; ++i) rest.push_back(points[4 * (i / 2) + 2 + i % 2]);
  split == Split::faces_by_fan ? add_fan(scene, rest) : add_by_ears(scene, std::move(rest));
}

void add_gear(Scene& scene, const glm::dvec3& top_center, double radius, double thickness, double phase, Split split) {
  const Outline top = outline(top_center, radius, phase, 1);
  const glm::dvec3 down(0, 0, -thickness);
  const bool whole = split == Split::nothing || split == Split::rim;
  const auto add_face = [&](const Outline& points) { whole ? scene.add_polygon(points) : add_split(scene, points, split); };
  add_face(top);
  for (std::size_t i = 0; i < kCorners; ++i) {
    const glm::dvec3 &here = top[i], &next = top[(i + 1) % kCorners];
    const std::array<glm::dvec3, 4> side{here, here + down, next + down, next};
    split == Split::rim ? add_fan(scene, {side.begin(), side.end()}) : scene.add_polygon(side);
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

Scene make(int size, Split split) {
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
        add_gear(scene, top_center, radius, thickness, std::numbers::pi * ((x + y + z) % 2) / kTeeth, split);
        scene.end_object();
      }
    }
  }
  return scene;
}

}  // namespace

Scene make_gears(int size) { return make(size, Split::nothing); }

Scene make_split_gears(int size) { return make(size, Split::faces_by_fan); }

Scene make_ear_gears(int size) { return make(size, Split::faces_by_ears); }

Scene make_rim_gears(int size) { return make(size, Split::rim); }

}  // namespace raymeter
