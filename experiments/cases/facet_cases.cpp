// Triangles and polygons: ties, planes, slivers, garbage; where rays begin and end on them.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "core/scene/surface.h"
#include "experiments/cases/recipes.h"
#include "experiments/verify/triangle_truth.h"

namespace raymeter::cases {

namespace {

constexpr std::int32_t kNothing = ExpectedHits::kNothing;
constexpr std::int32_t kUnknown = ExpectedHits::kUnknown;

constexpr glm::dvec3 kUp(0, 0, 1);

}  // namespace

Problem ties(int, std::uint64_t) {
  Problem problem;
  add_rectangle(problem.scene, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  for (const double x : {0.0, 0.25, 0.5, 1.0}) {
    for (const double distance : {1.0, 0.5, 3.0}) add(problem, ray({x, x, -distance}, kUp), 0, distance);
  }
  const std::int32_t fan = 2;
  for (int k = 0; k < 64; ++k) {
    const double a = k * 0.09817477042468103, b = (k + 1) % 64 * 0.09817477042468103;
    problem.scene.add_triangle({5, 5, 0}, {5 + std::cos(a), 5 + std::sin(a), 0}, {5 + std::cos(b), 5 + std::sin(b), 0});
  }
  const glm::dvec3 center(5, 5, 0);
  for (const glm::dvec3& from : {glm::dvec3(0, 0, -1), glm::dvec3(0.25, -0.5, 1), glm::dvec3(-0.125, 0.5, 2), glm::dvec3(3, 1, -4)}) {
    add(problem, ray(center + from, -from), fan, 1);
  }
  return finished(std::move(problem));
}

Problem coplanar(int count, std::uint64_t seed) {
  Problem problem;
  const std::array<glm::dvec3, 4> first{{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}}}, second{{{1, 1, 0}, {3, 1, 0}, {3, 3, 0}, {1, 3, 0}}};
  problem.scene.add_polygon(first);
  problem.scene.add_polygon(second);
  for (const glm::dvec3& at : {glm::dvec3(10, 0, 0), glm::dvec3(11, 1, 0)}) add_rectangle(problem.scene, at, {2, 0, 0}, {0, 2, 0});  // 2, 3; 4, 5
  Random random(seed);
  for (int k = 0; k < count; ++k) {
    const glm::dvec3 at(random.uniform(1.1, 1.9), random.uniform(1.1, 1.9), 0);
    const glm::dvec3 org(random.uniform(-4, 4), random.uniform(-4, 4), random.uniform(1, 3));
    add(problem, ray(org, at - org), 0);
    // Triangles' t is exact where the plane is one of equal depth.
    const glm::dvec3 beside(10, 0, 0), above = at + glm::dvec3(random.uniform(-1, 1), random.uniform(-1, 1), 2);
    if (std::abs(at.y - at.x) > 0.01) add(problem, ray(above + beside, at - above), at.y > at.x ? 3 : 2);
  }
  return finished(std::move(problem));
}

/// All in whole numbers, so that rays are in the planes exactly. Planes parallel to two axes, or to one and at 45 degrees to the others, are seen without
/// rounding: there rays miss. In the others a facet may be seen with an area, and met; and so may the side of a cone along which rays run.
Problem tilted_plane(int count, std::uint64_t seed) {
  constexpr std::array<std::array<glm::dvec3, 2>, 11> kPlanes{{
      {{{0, 1, 0}, {0, 0, 1}}},
      {{{1, 0, 0}, {0, 0, 1}}},
      {{{1, 0, 0}, {0, 1, 0}}},
      {{{1, 1, 0}, {0, 0, 1}}},
      {{{1, 0, -1}, {0, 1, 0}}},  // seen without rounding
      {{{1, -1, 0}, {0, 1, -1}}},
      {{{-3, 2, 1}, {2, 1, -3}}},
      {{{2, -1, 0}, {3, 0, -1}}},
      {{{5, 3, 0}, {0, 7, 5}}},
      {{{1, 0, 16}, {0, 1, 3}}},
      {{{3, 0, 1}, {0, 1, 0}}},
  }};
  constexpr std::size_t kExact = 5, kFacets = 8;
  Problem problem;
  Random random(22);
  const auto whole = [](Random& numbers, int reach) { return static_cast<double>(numbers.below(static_cast<std::size_t>(2 * reach + 1))) - reach; };
  std::array<std::array<glm::dvec3, 2 * kFacets>, kPlanes.size()> inside{};  // a point of each facet
  for (std::size_t plane = 0; plane < kPlanes.size(); ++plane) {
    const glm::dvec3 middle(4096.0 * static_cast<double>(plane), 0, 0);
    const auto at = [&](double x, double y) { return middle + x * kPlanes[plane][0] + y * kPlanes[plane][1]; };
    for (std::size_t k = 0; k < kFacets; ++k) {
      const double x = whole(random, 8), y = whole(random, 8), width = 4 + whole(random, 3), height = 4 + whole(random, 3);
      problem.scene.add_triangle(at(x, y), at(x + 2 * width, y + whole(random, 3)), at(x + whole(random, 3), y + 2 * height));
      problem.scene.add_polygon(
          std::array{at(y, x), at(y + 3 * width, x), at(y + 3 * width, x + 2), at(y + 2, x + 2), at(y + 2, x + 3 * height), at(y, x + 3 * height)});
      inside[plane][2 * k] = at(x + 1, y + 1);
      inside[plane][2 * k + 1] = at(y + 1, x + 1);
    }
  }
  // Two that are known to be met: with scalar and SSE4.2, and with FMA.
  problem.scene.add_triangle({0, -1, 4097}, {-5, 2, 4099}, {-8, -8, 4112});
  problem.scene.add_triangle({-3, -6, 8201}, {0, -7, 8199}, {-6, -6, 8204});
  add(problem, ray({-32, -32, 4160}, {83, 89, -172}, 0, 2), kUnknown);
  add(problem, ray({-32, 24, 8200}, {87, -91, 4}, 0, 2), kUnknown);
  for (int k = 0; k < 8; ++k) {
    const glm::dvec3 base(-4096, 512.0 * k, whole(random, 60)), axis(3, 4, 0), across(-4, 3, 0);
    const bool pointed = k % 2 != 0;
    problem.scene.add_cone(base, 5, base + (1.0 + k) * axis, pointed ? 0 : 5);
    const glm::dvec3 side = pointed ? (1.0 + k) * axis - across : axis;
    for (int back = 0; back < 8; ++back) add(problem, ray(base + across - static_cast<double>(back) * side, side, 0, 16), kUnknown);
  }
  Random aims(seed);
  for (int k = 0; k < count; ++k) {
    const std::size_t plane = aims.below(kPlanes.size());
    const double x = whole(aims, 60), y = whole(aims, 60);
    const glm::dvec3 org = glm::dvec3(4096.0 * static_cast<double>(plane), 0, 0) + x * kPlanes[plane][0] + y * kPlanes[plane][1];
    const glm::dvec3 dir = inside[plane][aims.below(2 * kFacets)] - org;
    if (dir == glm::dvec3(0)) continue;
    add(problem, ray(org, dir, 0, 2), plane < kExact ? kNothing : kUnknown);
  }
  return finished(std::move(problem));
}

Problem coincident_triangles(int, std::uint64_t) {
  Problem problem;
  for (int k = 0; k < 20'000; ++k) problem.scene.add_triangle({0, 0, 0}, {1, 0, 0.25}, {0, 1, 0});
  for (int k = 0; k < 16; ++k) add(problem, ray({0.05 * k, 0.2, 1}, {0, 0, -1}), 0);
  for (int k = 0; k < 4; ++k) add(problem, ray({1.1, 0.2 * k, 1}, {0, 0, -1}), kNothing);
  return finished(std::move(problem));
}

Problem degenerate(int, std::uint64_t) {
  Problem problem;
  Scene& scene = problem.scene;
  scene.add_triangle({0, 0, 0}, {0, 0, 0}, {1, 1, 0});
  scene.add_triangle({0, 0, 0}, {1, 1, 0}, {2, 2, 0});
  scene.add_triangle({3, 3, 3}, {3, 3, 3}, {3, 3, 3});
  const double x = -1113.45459, z = -56.2431908;  // of pbrt's tests
  scene.add_triangle({x, -79.049614, z}, {x, -87.0922699, z}, {x, -79.2090149, z});
  for (const double at : {0.0, 0.5, 1.0, 2.0}) {
    add(problem, ray({at, at, -1}, kUp), kNothing);
    add(problem, ray({at, at, -1}, {0.25, 0, 1}), kNothing);
  }
  add(problem, ray({3, 3, 0}, kUp), kNothing);
  add(problem, ray({0, 0, 0}, {1, 1, 1}), kNothing);
  add(problem, ray({-1081.47925, 99.9999542, 87.7701111}, {-32.1072998, -183.355865, -144.607635}, 0, 0.9999f), kNothing);
  return finished(std::move(problem));
}

Problem slivers(int, std::uint64_t) {
  Problem problem;
  std::int32_t prim = 0;
  for (const int exponent : {20, 23, 40}) {
    const double h = std::ldexp(1.0, -exponent), y = 4.0 * prim;
    problem.scene.add_triangle({0, 0, y}, {1, 0, y}, {1, h, y});
    add(problem, ray({0.75, h / 4, y - 1}, kUp, 0, 2), prim, 1);
    add(problem, ray({0.5, 0, y - 1}, kUp, 0, 2), prim, 1);
    add(problem, ray({0.75, h, y - 1}, kUp, 0, 2), kNothing);
    add(problem, ray({0.75, -h / 4, y - 1}, kUp, 0, 2), kNothing);
    ++prim;
  }
  return finished(std::move(problem));
}

Problem extreme_directions(int, std::uint64_t) {
  Problem problem;
  problem.scene.add_triangle({-1, -1, 1}, {3, -1, 1}, {-1, 3, 1});
  problem.scene.add_sphere({-4, 0, 2}, 1);
  for (const float d : {1e-20f, 1e20f, 0x1p-126f, 0x1p126f, 0x1p-127f, 0x1p-128f, 0x1p-140f, 0x1p-149f}) {
    const double t = 1 / double{d};
    const bool reached = t <= double{std::numeric_limits<float>::max()};
    for (const float x : {0.0f, -4.0f}) {
      add(problem, Ray{{x, 0, 0}, 0, {0, 0, d}, kInf}, reached ? (x == 0 ? 0 : 1) : kNothing, t);
      add(problem, Ray{{x, 0, 0}, 0, {0, 0, -d}, kInf}, kNothing);
    }
  }
  return finished(std::move(problem));
}

/// A strip of triangles that share vertices, and spheres, whose numbers are random bits; rays of random bits. What readers make of damaged files:
/// tests/experiments/garbage_meshes_test.cpp.
Problem garbage(int count, std::uint64_t seed) {
  Problem problem;
  Random random(57);
  std::vector<glm::dvec3> vertices;
  for (int k = 0; k < 300; ++k) {
    glm::dvec3 v;
    for (glm::length_t a = 0; a < 3; ++a) v[a] = double{std::bit_cast<float>(random.bits())};
    vertices.push_back(v);
  }
  for (std::size_t k = 0; k + 2 < vertices.size(); ++k) problem.scene.add_triangle(vertices[k], vertices[k + 1], vertices[k + 2]);
  for (std::size_t k = 0; k < 50; ++k) problem.scene.add_sphere(vertices[k], double{std::bit_cast<float>(random.bits())});
  Random aims(seed);
  for (int k = 0; k < count; ++k) {
    Ray r{{}, 0, {}, kInf};
    for (std::size_t a = 0; a < 3; ++a) {
      r.org[a] = std::bit_cast<float>(aims.bits());
      r.dir[a] = std::bit_cast<float>(aims.bits());
    }
    problem.set.rays.push_back(r);
    // So long a direction makes t of what is near denormal, and no multiple of it comes near the surface.
    const float longest = std::max({std::abs(r.dir[0]), std::abs(r.dir[1]), std::abs(r.dir[2])});
    problem.set.expected.excused.push_back(longest >= 0x1p120f && longest < kInf);
  }
  return finished(std::move(problem));
}

Problem spawned(int count, std::uint64_t seed) {
  constexpr int kTriangles = 1000;
  Problem problem;
  Random random(59);
  const auto magnitude = [&] { return std::pow(10.0, random.uniform(-8, 8)) * (random.below(2) == 0 ? 1 : -1); };
  const auto vertex = [&] {
    const double x = magnitude(), y = magnitude();
    return glm::dvec3(x, y, magnitude());
  };
  for (int k = 0; k < kTriangles; ++k) {
    const glm::dvec3 a = vertex(), b = vertex();
    problem.scene.add_triangle(a, b, vertex());
  }
  problem.scene.finish();
  Random aims(seed);
  while (static_cast<int>(problem.set.rays.size()) < count) {
    const auto prim = static_cast<std::int32_t>(aims.below(kTriangles));
    const verify::TriangleShape shape = verify::triangle_at(problem.scene.pools(), static_cast<std::size_t>(prim));
    const auto corner = [&](std::size_t k) { return glm::dvec3(shape.vertex[k][0], shape.vertex[k][1], shape.vertex[k][2]); };
    double u = aims.uniform(), v = aims.uniform();
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const glm::dvec3 at = corner(0) + u * (corner(1) - corner(0)) + v * (corner(2) - corner(0));
    const glm::dvec3 from = at + (glm::length(at) + 1) * std::pow(10.0, aims.uniform(-3, 3)) * aims.direction();
    const Ray seen = ray(from, glm::normalize(at - glm::dvec3(glm::vec3(from))));
    const verify::TrueHits met = verify::true_hits(seen, shape);
    if (met.count == 0) continue;
    const Surface surface = surface_at(problem.scene, seen, static_cast<float>(met.t[0]), prim);
    problem.set.rays.push_back(aims.below(2) == 0 ? spawn_ray(surface, aims.direction()) : spawn_ray_to(surface, vertex()));
    problem.set.expected.source.push_back(prim);
  }
  return problem;
}

Problem contacts(int, std::uint64_t) {
  Problem problem;
  std::vector<Ray> rays;
  constexpr int kSteps = 12;  // gaps of 1, 2, 4 ... roundings of a coordinate
  for (int k = 0; k < kSteps; ++k) {
    const double gap = std::ldexp(1.0, k - 23);
    for (const double z : {1.0, 1.0 + gap}) problem.scene.add_triangle({4.0 * k, 0, z}, {4.0 * k + 1, 0, z}, {4.0 * k, 1, z});
  }
  problem.scene.finish();
  // From beside the lower one, lifted off by what a spawned ray is, through the gap: the upper one is met where the gap is wider than that.
  for (int k = 0; k < kSteps; ++k) {
    const Ray seen = ray({4.0 * k + 0.25, 0.25, 0}, kUp);
    const Surface surface = surface_at(problem.scene, seen, 1, 2 * k);
    const double gap = std::ldexp(1.0, k - 23);
    add(problem, spawn_ray(surface, kUp), gap > surface.clearance + 0x1p-23 ? 2 * k + 1 : kUnknown);
    problem.set.expected.source.push_back(2 * k);
  }
  return problem;
}

Problem shadow_ends(int, std::uint64_t) {
  Problem problem;
  Scene& scene = problem.scene;
  problem.set.query = Query::any;
  add_rectangle(scene, {0, 0, 0}, {8, 0, 0}, {0, 8, 0});  // the floor
  add_rectangle(scene, {0, 0, 1}, {8, 0, 0}, {0, 8, 0});  // in which the lights are
  add_rectangle(scene, {4, 0, 0.5}, {4, 0, 0}, {0, 8, 0});
  scene.finish();
  for (int x = 1; x < 16; ++x) {
    for (int y = 1; y < 16; ++y) {
      const glm::dvec3 foot(x / 2.0, y / 2.0, 0);
      const Surface surface = surface_at(scene, ray(foot + kUp, -kUp), 1, y > x ? 1 : 0);
      const LightTarget light = light_targets(scene, std::array{Light{foot + kUp}}, 1)[0];
      add(problem, spawn_ray_to(surface, light), x >= 8 ? (y > 2 * (x - 8) ? 5 : 4) : kNothing);  // a blocker is all that counts
      problem.set.expected.source.push_back(y > x ? 1 : 0);
      add(problem, spawn_ray_to(surface, foot + glm::dvec3(3, 2, 0x1p-10)), kNothing);  // along the floor
      problem.set.expected.source.push_back(y > x ? 1 : 0);
    }
  }
  return problem;
}

}  // namespace raymeter::cases
