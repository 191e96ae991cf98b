// Rays in the planes of boxes, cells and splits, at the ends of their intervals, and of no meaning.

#include "experiments/cases/recipes.h"

namespace raymeter::cases {

namespace {

constexpr float kUlp = 0x1p-23f;  // of 1
constexpr float kBelowZero = -0x1p-149f;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr std::int32_t kNothing = ExpectedHits::kNothing;
constexpr std::int32_t kUnknown = ExpectedHits::kUnknown;

Problem unit_box() {
  Problem problem;
  add_box(problem.scene, {0, 0, 0}, {1, 1, 1});
  return problem;
}

/// A ray along an axis at the unit box, from 1 in front of it; x, y: its place on the face, along the next axes. `signs`: of its zeros.
Ray along_axis(glm::length_t axis, bool down, float x, float y, unsigned signs) {
  Ray r{{}, 0, {}, kInf};
  const std::size_t a = static_cast<std::size_t>(axis), b = (a + 1) % 3, c = (a + 2) % 3;
  r.org[a] = down ? 2 : -1;
  r.dir[a] = down ? -1 : 1;
  r.org[b] = x;
  r.org[c] = y;
  r.dir[b] = signs & 1 ? -0.0f : 0.0f;
  r.dir[c] = signs & 2 ? -0.0f : 0.0f;
  return r;
}

/// Calls each(axis, down, signs).
template <class Each>
void for_each_axis_ray(Each&& each) {
  for (glm::length_t axis = 0; axis < 3; ++axis) {
    for (const bool down : {false, true}) {
      for (unsigned signs = 0; signs < 4; ++signs) each(axis, down, signs);
    }
  }
}

/// Perpendicular unit vectors: two of the world's turned by 45 degrees about the third, so that their faces are among those of k-DOPs.
std::array<glm::dvec3, 3> turned_by_45_degrees(std::size_t about) {
  const double half = std::sqrt(0.5);
  std::array<glm::dvec3, 3> axes{glm::dvec3(0.0), glm::dvec3(0.0), glm::dvec3(0.0)};
  const std::size_t x = (about + 1) % 3, y = (about + 2) % 3;
  const auto set = [&](std::size_t axis, std::size_t a, double value) { axes[axis][static_cast<glm::length_t>(a)] = value; };
  set(about, about, 1);
  set(x, x, half);
  set(x, y, half);
  set(y, x, -half);
  set(y, y, half);
  return axes;
}

/// Any perpendicular unit vectors.
std::array<glm::dvec3, 3> turned(Random& random) {
  const glm::dvec3 x = random.direction(), y = glm::normalize(glm::cross(x, random.direction()));
  return {x, y, glm::cross(x, y)};
}

}  // namespace

Problem axis_rays(int, std::uint64_t) {
  Problem problem = unit_box();
  for_each_axis_ray([&](glm::length_t axis, bool down, unsigned signs) {
    for (const float x : {0.0f, 0.25f, 0.5f, 1.0f}) {
      for (const float y : {0.0f, 0.5f, 0.75f, 1.0f}) {
        const auto face = static_cast<std::int32_t>(2 * axis + (down ? 1 : 0));
        add(problem, along_axis(axis, down, x, y, signs), 2 * face + (y > x ? 1 : 0), 1);
      }
    }
  });
  return finished(std::move(problem));
}

Problem beside_box(int, std::uint64_t) {
  Problem problem = unit_box();
  for_each_axis_ray([&](glm::length_t axis, bool down, unsigned signs) {
    for (const float at : {1 + kUlp, kBelowZero, -0x1p-126f}) {
      for (const Ray& r : {along_axis(axis, down, at, 0.5f, signs), along_axis(axis, down, 0.5f, at, signs)}) {
        add(problem, r, kNothing);
        // A product with 2^-149 underflows, and a weight of 0 is an edge: within the declared errors.
        problem.set.expected.excused.push_back(at == kBelowZero);
      }
    }
  });
  return finished(std::move(problem));
}

Problem flat_plane(int, std::uint64_t) {
  Problem problem;
  for (int x = 0; x < 4; ++x) {
    for (int y = 0; y < 4; ++y) add_rectangle(problem.scene, {x, y, 0}, {1, 0, 0}, {0, 1, 0});
  }
  for (int x = 0; x <= 8; ++x) {
    for (int y = 0; y <= 8; ++y) {
      const glm::dvec3 at(x / 2.0, y / 2.0, 0);
      add(problem, ray(at - glm::dvec3(0, 0, 1), {0, -0.0, 1}), kUnknown);
      add(problem, ray(at + glm::dvec3(0, 0, 2), {-0.0, 0, -1}), kUnknown);
      add(problem, ray(at - glm::dvec3(5, 0, 0), {1, 0, 0}), kNothing);  // in the plane
      add(problem, ray(at + glm::dvec3(0, 6, 0), {0, -1, -0.0}), kNothing);
      add(problem, ray(at - glm::dvec3(5, 5, 0), {1, 1, 0}), kNothing);
    }
  }
  return solved(std::move(problem));
}

Problem negative_zero(int, std::uint64_t) {
  Problem problem;
  problem.scene.add_triangle({1, -1, 1}, {1, 1, 1}, {-1, 1, 1});
  problem.scene.add_triangle({1, -1, 2.1}, {1, 1, 2.1}, {-1, 1, 2.1});
  for (const double x : {0.0, -0.0}) {
    for (const double y : {0.0, -0.0}) add(problem, ray({0.25, 0.25, 0}, {x, y, 1}), 0, 1);
  }
  return finished(std::move(problem));
}

Problem interval_ends(int, std::uint64_t) {
  Problem problem = unit_box();
  problem.scene.add_sphere({4, 0, 0}, 1);
  const std::int32_t sphere = 12, front = 8, back = 10;  // the faces of least and greatest z
  const auto at_box = [&](float t_min, float t_max, std::int32_t prim, double t) { add(problem, ray({0.5, 0.25, -1}, {0, 0, 1}, t_min, t_max), prim, t); };
  const auto at_sphere = [&](float t_min, float t_max, std::int32_t prim, double t) { add(problem, ray({4, 0, -3}, {0, 0, 1}, t_min, t_max), prim, t); };
  const float after_one = 1 + kUlp, before_one = 1 - kUlp / 2, after_two = 2 + 2 * kUlp, before_two = 2 - kUlp, after_four = 4 + 4 * kUlp;
  at_box(0, 1, front, 1);
  at_box(-0.0f, 1, front, 1);
  at_box(1, 1, front, 1);
  at_box(1, kInf, front, 1);
  at_box(0, before_one, kNothing, 0);
  at_box(after_one, kInf, back, 2);
  at_box(2, 2, back, 2);
  at_box(2, kInf, back, 2);
  at_box(after_one, before_two, kNothing, 0);
  at_box(after_two, kInf, kNothing, 0);
  at_box(-kInf, kInf, front, 1);
  at_sphere(0, 2, sphere, 2);
  at_sphere(2, 2, sphere, 2);
  at_sphere(0, before_two, kNothing, 0);
  at_sphere(after_two, kInf, sphere, 4);
  at_sphere(4, 4, sphere, 4);
  at_sphere(after_two, 4 - 2 * kUlp, kNothing, 0);
  at_sphere(after_four, kInf, kNothing, 0);
  // Behind the origin.
  add(problem, ray({0.5, 0.25, 0.5}, {0, 0, 1}, -kInf), front, -0.5);
  add(problem, ray({0.5, 0.25, 0.5}, {0, 0, 1}, -0.5f), front, -0.5);
  add(problem, ray({0.5, 0.25, 0.5}, {0, 0, 1}, -0.5f + kUlp / 4), back, 0.5);
  add(problem, ray({4, 0, 0}, {0, 0, 1}, -1), sphere, -1);
  add(problem, ray({4, 0, 0}, {0, 0, 1}, -1 + kUlp / 2), sphere, 1);
  add(problem, ray({0.5, 0.25, 3}, {0, 0, 1}, -kInf, -1), front, -3);
  return finished(std::move(problem));
}

Problem start_on_surface(int, std::uint64_t) {
  Problem problem = unit_box();
  for (int x = 0; x <= 2; ++x) {
    for (int y = 0; y <= 2; ++y) {
      for (int z = 0; z <= 2; ++z) {
        for (int code = 0; code < 27; ++code) {
          const glm::dvec3 dir(code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1);
          if (dir != glm::dvec3(0)) add(problem, ray(glm::dvec3(x, y, z) / 2.0, dir), kUnknown);
        }
      }
    }
  }
  return solved(std::move(problem));
}

Problem lattice(int count, std::uint64_t seed) {
  constexpr int kCells = 8;
  Problem problem;
  Random random(5);                // the scene's own
  for (int k = 0; k < 400; ++k) {  // squares in the planes of the lattice, and triangles that touch them from either side
    const glm::dvec3 at(static_cast<double>(random.below(kCells)), static_cast<double>(random.below(kCells)), static_cast<double>(random.below(kCells)));
    glm::dvec3 x(0.0), y(0.0), z(0.0);
    const auto axis = static_cast<glm::length_t>(random.below(3));
    x[axis] = y[(axis + 1) % 3] = z[(axis + 2) % 3] = 1;
    if (k % 2 == 0)
      add_rectangle(problem.scene, at, x, y);
    else
      problem.scene.add_triangle(at, at + x, at + (k % 4 == 1 ? 1.0 : -1.0) * z + y);
  }
  constexpr std::array kPlaces{-1, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
  for (int k = 0; k < count; ++k) {
    glm::dvec3 org(0.0), dir(0.0);
    for (glm::length_t a = 0; a < 3; ++a) {
      org[a] = kPlaces[random.below(kPlaces.size())] + (random.below(4) == 0 ? 0.5 : 0.0);
      dir[a] = static_cast<double>(random.below(3)) - 1;
      if (dir[a] == 0 && random.below(2) == 0) dir[a] = -0.0;
    }
    if (dir == glm::dvec3(0)) dir[static_cast<glm::length_t>(random.below(3))] = 1;
    add(problem, ray(org, dir), kUnknown);
  }
  (void)seed;
  return solved(std::move(problem));
}

Problem occluder(int count, std::uint64_t seed) {
  Problem problem;
  problem.scene.add_triangle({-100, -100, 10}, {200, -100, 30}, {-100, 200, 20});  // through all cells
  Random random(6);
  for (int k = 0; k < 500; ++k) {  // small ones behind and before it
    const glm::dvec3 at(random.uniform(0, 16), random.uniform(0, 16), random.uniform(0, 32));
    problem.scene.add_triangle(at, at + glm::dvec3(0.5, 0, 0.25), at + glm::dvec3(0, 0.5, -0.25));
  }
  Random aims(seed);
  for (int k = 0; k < count; ++k) {
    const glm::dvec3 org(aims.uniform(0, 16), aims.uniform(0, 16), aims.below(2) == 0 ? -1 : 33);
    const glm::dvec3 at(aims.uniform(0, 16), aims.uniform(0, 16), aims.uniform(0, 32));
    problem.set.rays.push_back(ray(org, at - org));
  }
  return finished(std::move(problem));
}

Problem far_behind(int, std::uint64_t) {
  Problem problem = unit_box();
  for_each_axis_ray([&](glm::length_t axis, bool down, unsigned signs) {
    for (const int exponent : {10, 20, 40, 59, 60, 61, 80, 100, 101, 110, 120}) {
      for (const float speed : {1.0f, 0x1p-5f, 0x1p-149f}) {
        const auto a = static_cast<std::size_t>(axis);
        Ray r = along_axis(axis, down, 0.25f, 0.5f, signs);
        r.org[a] = std::ldexp(down ? -1.5f : 1.5f, exponent);
        r.dir[a] *= speed;
        r.t_min = -kInf;
        add(problem, r, kUnknown);
      }
    }
  });
  return solved(std::move(problem));
}

Problem denormal_directions(int count, std::uint64_t seed) {
  constexpr double kUnit = 0x1p-25;  // so that a t is a float
  Problem problem;
  Random random(13);
  for (int k = 0; k < 20; ++k) {
    const glm::dvec3 low = kUnit * glm::dvec3(glm::ivec3(random.in_cube(8)));
    add_box(problem.scene, low, low + kUnit * (1.0 + static_cast<double>(random.below(3))));
  }
  Random aims(seed);
  for (int k = 0; k < count; ++k) {
    Ray r{{}, k % 4 == 0 ? -kInf : 0, {}, kInf};
    for (std::size_t a = 0; a < 3; ++a) {
      r.org[a] = static_cast<float>(kUnit / 2 * static_cast<double>(static_cast<int>(aims.below(41)) - 20));
      r.dir[a] = std::ldexp(aims.below(2) == 0 ? -1.0f : 1.0f, -149 + static_cast<int>(aims.below(23)));
      if (aims.below(3) == 0) r.dir[a] = std::copysign(0.0f, r.dir[a]);
    }
    add(problem, r, kUnknown);
  }
  return finished(std::move(problem));
}

Problem invalid_rays(int count, std::uint64_t seed) {
  Problem problem = unit_box();
  Random random(seed);
  for (int k = 0; k < count; ++k) {
    const float x = static_cast<float>(random.uniform(0.25, 0.75)), y = static_cast<float>(random.uniform(0, 0.25));
    add(problem, along_axis(0, k % 2 != 0, x, y, 0), k % 2 == 0 ? 0 : 2, 1);
    if (k % 3 != 0) continue;
    Ray bad = along_axis(0, false, x, y, 0);
    float* const field[8] = {bad.org, bad.org + 1, bad.org + 2, bad.dir, bad.dir + 1, bad.dir + 2, &bad.t_min, &bad.t_max};
    switch (const std::size_t how = random.below(20)) {
      case 17: bad.dir[0] = bad.dir[1] = bad.dir[2] = k % 2 == 0 ? 0.0f : -0.0f; break;
      case 18: bad.t_min = 3, bad.t_max = 2; break;
      case 19: bad.t_max = -kInf; break;
      case 16: bad.t_min = kInf; break;
      default: *field[how % 8] = how < 8 ? kNan : how % 8 < 6 ? (k % 2 == 0 ? kInf : -kInf) : kNan;
    }
    add(problem, bad, kNothing);
  }
  return finished(std::move(problem));
}

template <int kOffset, bool kTurned>
Problem box_edges(int count, std::uint64_t seed) {
  Problem problem;
  const glm::dvec3 middle = double{kOffset} * glm::dvec3(1, 1.3, 1.6);
  Random random(10);
  std::vector<Corners> boxes;
  for (int k = 0; k < 40; ++k) {  // so few that `list` and the oracle can be asked of ten million rays
    const glm::dvec3 low = glm::dvec3(glm::vec3(middle + random.in_cube(15))), extent = (random.in_cube(0.5) + 0.55) * std::exp2(random.uniform(-3, 2));
    std::array<glm::dvec3, 3> axes{glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)};
    if (kTurned) axes = k % 2 == 0 ? turned_by_45_degrees(random.below(3)) : turned(random);
    for (std::size_t a = 0; a < 3; ++a) axes[a] *= extent[static_cast<glm::length_t>(a)];
    for (glm::dvec3& corner : boxes.emplace_back(corners_at(low, axes))) corner = glm::dvec3(glm::vec3(corner));
    add_box(problem.scene, boxes.back());
  }
  Random aims(seed);
  for (int k = 0; k < count; ++k) {
    const Corners& corners = boxes[aims.below(boxes.size())];
    const std::size_t edge = aims.below(12), along = edge / 4;
    const std::size_t from = (edge & 1) << (along + 1) % 3 | (edge >> 1 & 1) << (along + 2) % 3;
    const glm::dvec3 at = corners[from] + aims.uniform() * (corners[from | std::size_t{1} << along] - corners[from]);
    const glm::dvec3 org(glm::vec3(at + aims.uniform(1, 60) * aims.direction()));
    problem.set.rays.push_back(ray(org, glm::normalize(at - org)));
  }
  return finished(std::move(problem));
}

template Problem box_edges<0, false>(int count, std::uint64_t seed);
template Problem box_edges<100000, false>(int count, std::uint64_t seed);
template Problem box_edges<0, true>(int count, std::uint64_t seed);
template Problem box_edges<100000, true>(int count, std::uint64_t seed);

}  // namespace raymeter::cases
