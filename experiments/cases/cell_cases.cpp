// Rays on long ways through the cells of a grid, whose errors may add up.

#include "experiments/cases/recipes.h"

namespace raymeter::cases {

namespace {

constexpr double kSide = 64, kHeight = 1;

/// Small triangles in a flat box, as long as wide, so that rays take many steps before they meet one. Its corners are taken, so that the planes of x and y are
/// the same numbers.
Scene flat_box() {
  Scene scene;
  scene.add_triangle({0, 0, 0}, {0.5, 0, 0}, {0, 0.5, 0});
  scene.add_triangle({kSide, kSide, kHeight}, {kSide - 0.5, kSide, kHeight}, {kSide, kSide - 0.5, kHeight});
  Random random(14);
  for (int k = 0; k < 1500; ++k) {
    const glm::dvec3 at(random.uniform(1, kSide - 1), random.uniform(1, kSide - 1), random.uniform(0.1, kHeight - 0.1));
    scene.add_triangle(at, at + 0.1 * random.direction(), at + 0.1 * random.direction());
  }
  return scene;
}

glm::dvec3 inside(Random& aims) {
  const double x = aims.uniform(0, kSide), y = aims.uniform(0, kSide);
  return {x, y, aims.uniform(0, kHeight)};
}

double sign(Random& aims) { return aims.below(2) == 0 ? -1 : 1; }

/// From a random point to another.
Ray across(Random& aims) {
  const glm::dvec3 org = inside(aims);
  return ray(org, inside(aims) - org);
}

/// Along the diagonal of x and y through a corner of cells and so through those of all of its cells, 2^-28 to 2^-18 beside it.
Ray through_corners(Random& aims) {
  const auto beside = [&aims] { return sign(aims) * std::exp2(aims.uniform(-28, -18)); };
  const bool back = aims.below(2) == 0;
  const double s = back ? kSide - aims.uniform(0, 8) : aims.uniform(0, 8);
  const double pace = (back ? -1 : 1) * std::exp2(aims.uniform(-2, 2));
  return ray({s, s + kSide * beside(), aims.uniform(0.25, 0.75) * kHeight}, {pace, pace * (1 + beside()), sign(aims) * pace * aims.uniform(0, 0.25 / kSide)});
}

/// All but along an axis, 2^-14 to 2^-6 off it.
Ray along_rows(Random& aims) {
  const auto axis = static_cast<glm::length_t>(aims.below(2));
  glm::dvec3 org = inside(aims), dir(0.0);
  dir[axis] = sign(aims);
  org[axis] = dir[axis] < 0 ? kSide + 1 : -1;
  dir[1 - axis] = sign(aims) * std::exp2(aims.uniform(-14, -6));
  dir[2] = sign(aims) * std::exp2(aims.uniform(-14, -6));
  return ray(org, dir);
}

Problem with_rays(int count, std::uint64_t seed, Ray (*aim)(Random&)) {
  Problem problem;
  problem.scene = flat_box();
  Random aims(seed);
  for (int k = 0; k < count; ++k) problem.set.rays.push_back(aim(aims));
  return finished(std::move(problem));
}

}  // namespace

Problem cells_across(int count, std::uint64_t seed) { return with_rays(count, seed, across); }
Problem cell_corners(int count, std::uint64_t seed) { return with_rays(count, seed, through_corners); }
Problem cell_rows(int count, std::uint64_t seed) { return with_rays(count, seed, along_rows); }

}  // namespace raymeter::cases
