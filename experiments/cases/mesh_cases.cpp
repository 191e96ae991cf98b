// Closed meshes: from inside every ray hits, at vertices, edges and faces.

#include <algorithm>
#include <numbers>
#include <vector>

#include "experiments/cases/recipes.h"
#include "experiments/scenes/gen/gen_scene.h"
#include "experiments/verify/triangle_truth.h"

namespace raymeter::cases {

namespace {

constexpr std::int32_t kSomething = ExpectedHits::kSomething;

struct Corners {
  glm::dvec3 a, b, c;
};

Corners corners(const Scene& scene, std::size_t triangle) {
  const auto at = [&](std::size_t k) {
    const auto& v = scene.pools().triangles.vertex[k];
    return glm::dvec3(v[0][triangle], v[1][triangle], v[2][triangle]);
  };
  return {at(0), at(1), at(2)};
}

Scene moved_sphere(int level, double scale, const glm::dvec3& center) {
  const Scene unit = make_icosphere(level);
  Scene scene;
  for (std::size_t i = 0; i < unit.pools().triangles.size(); ++i) {
    const auto [a, b, c] = corners(unit, i);
    scene.add_triangle(center + scale * a, center + scale * b, center + scale * c);
  }
  return scene;
}

/// Rays from within `half` of the center at vertices, points of edges and points of faces of triangles [first, end), a third each. Those at faces keep away
/// from edges: what they meet is known.
void add_rays_at_mesh(Problem& problem, const glm::dvec3& center, double half, int count, std::uint64_t seed, std::size_t first, std::size_t end,
                      int exponent_spread = 0) {
  Random random(seed);
  for (int k = 0; k < count; ++k) {
    const std::size_t i = first + random.below(end - first), turn = random.below(3);
    auto [a, b, c] = corners(problem.scene, i);
    if (turn == 1) std::swap(a, b);
    if (turn == 2) std::swap(a, c);
    const double s = random.uniform(), r = random.uniform(0.2, 0.8);
    const glm::dvec3 at = k % 3 == 0 ? a : k % 3 == 1 ? a + s * (b - a) : a + r * (b - a) + (1 - r) * 0.5 * (c - a);
    const glm::dvec3 org(glm::vec3(center + random.in_cube(half)));  // rounded first, so that the direction is off by its own rounding only
    const double scale =
        exponent_spread > 0 ? std::ldexp(1.0, static_cast<int>(random.below(2 * static_cast<std::size_t>(exponent_spread) + 1)) - exponent_spread) : 1;
    const Ray r_at = ray(org, scale * (at - org));
    if (k % 3 != 2) {
      add(problem, r_at, kSomething);
      continue;
    }
    const verify::TrueHits met = verify::true_hits(r_at, verify::triangle_at(problem.scene.pools(), i));
    add(problem, r_at, static_cast<std::int32_t>(i), met.count > 0 ? met.t[0] : kUnknownT);
  }
}

}  // namespace

template <int kExponent, int kLevel>
Problem closed_mesh(int count, std::uint64_t seed) {
  Problem problem;
  const double scale = std::ldexp(1.0, kExponent);
  problem.scene = moved_sphere(kLevel, scale, {0, 0, 0});
  add_rays_at_mesh(problem, {0, 0, 0}, 0.1 * scale, count, seed, 0, problem.scene.pools().triangles.size());
  return finished(std::move(problem));
}
template Problem closed_mesh<-60, 3>(int count, std::uint64_t seed);
template Problem closed_mesh<-50>(int count, std::uint64_t seed);
template Problem closed_mesh<-40>(int count, std::uint64_t seed);
template Problem closed_mesh<0>(int count, std::uint64_t seed);
template Problem closed_mesh<33>(int count, std::uint64_t seed);
template Problem closed_mesh<50>(int count, std::uint64_t seed);
template Problem closed_mesh<59>(int count, std::uint64_t seed);

Problem closed_mesh_far(int count, std::uint64_t seed) {
  Problem problem;
  const glm::dvec3 center(148376, 1234, -223423);
  problem.scene = moved_sphere(3, 2, center);
  // Vertices lie on a lattice of 1/64: rays at faces may meet neighbours.
  add_rays_at_mesh(problem, center, 0.5, count, seed, 0, problem.scene.pools().triangles.size());
  std::ranges::fill(problem.set.expected.prim, kSomething);
  std::ranges::fill(problem.set.expected.t, kUnknownT);
  return finished(std::move(problem));
}

Problem scaled_directions(int count, std::uint64_t seed) {
  Problem problem;
  problem.scene = moved_sphere(4, 1, {0, 0, 0});
  add_rays_at_mesh(problem, {0, 0, 0}, 0.1, count, seed, 0, problem.scene.pools().triangles.size(), 60);
  return finished(std::move(problem));
}

/// A star of many points, drawn out to a solid: two concave polygons, whose sides are triangles and quadrangles in turn.
Problem closed_polygons(int count, std::uint64_t seed) {
  constexpr int kCorners = 48;
  Problem problem;
  std::vector<glm::dvec3> top, bottom;
  for (int k = 0; k < kCorners; ++k) {
    const double angle = 2 * std::numbers::pi * k / kCorners, r = k % 2 == 0 ? 1.0 : 0.55;
    const glm::dvec3 at(glm::vec3(r * std::cos(angle), r * std::sin(angle), 0));
    top.push_back(at + glm::dvec3(0, 0, 0.5));
    bottom.push_back(at - glm::dvec3(0, 0, 0.5));
  }
  problem.scene.add_polygon(top);
  problem.scene.add_polygon(bottom);
  for (std::size_t k = 0; k < kCorners; ++k) {
    const std::size_t next = (k + 1) % kCorners;
    if (k % 2 == 0) {
      problem.scene.add_polygon(std::array{bottom[k], bottom[next], top[next], top[k]});
    } else {
      problem.scene.add_triangle(bottom[k], bottom[next], top[next]);
      problem.scene.add_triangle(bottom[k], top[next], top[k]);
    }
  }
  Random random(seed);
  for (int k = 0; k < count; ++k) {
    const std::vector<glm::dvec3>& ring = k % 2 == 0 ? top : bottom;
    const std::size_t corner = random.below(kCorners);
    const glm::dvec3 a = ring[corner], b = k % 3 == 0 ? (k % 2 == 0 ? bottom : top)[corner] : ring[(corner + 1) % kCorners];
    const glm::dvec3 at = k % 5 == 0 ? a : a + random.uniform() * (b - a), org(glm::vec3(random.in_cube(0.3)));
    add(problem, ray(org, at - org), kSomething);
  }
  return finished(std::move(problem));
}

Problem height_field(int count, std::uint64_t seed) {
  constexpr int kSize = 128;
  Problem problem;
  Random random(35);
  std::vector<int> height;
  for (int i = 0; i < (kSize + 1) * (kSize + 1); ++i) height.push_back(static_cast<int>(random.below(8)));
  const auto at = [&](int x, int y) { return glm::dvec3(x, y, height[static_cast<std::size_t>(y * (kSize + 1) + x)]); };
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      problem.scene.add_triangle(at(x, y), at(x + 1, y), at(x + 1, y + 1));
      problem.scene.add_triangle(at(x, y), at(x + 1, y + 1), at(x, y + 1));
    }
  }
  Random places(seed);
  const auto place = [&] { return static_cast<int>(places.below(2 * kSize + 1)); };
  for (int k = 0; k < count; ++k) {
    const int x = k % 8 == 0 ? 0 : k % 8 == 1 ? 2 * kSize : place(), y = k % 8 == 2 ? 0 : k % 8 == 3 ? 2 * kSize : place();  // half of them on borders
    const glm::dvec3 down(k & 8 ? -0.0 : 0.0, k & 16 ? -0.0 : 0.0, -1);
    // Middles of edges and diagonals, all of which run from (x, y) to (x + 1, y + 1).
    add(problem, ray({x / 2.0, y / 2.0, 100}, down), kSomething, 100 - (at(x / 2, y / 2).z + at((x + 1) / 2, (y + 1) / 2).z) / 2);
  }
  return finished(std::move(problem));
}

template <int kSize>
Problem mixed_scales(int count, std::uint64_t seed) {
  Problem problem;
  const double size = kSize;
  const glm::dvec3 center = size * glm::dvec3(1, 1, 1);
  problem.scene = moved_sphere(3, 1, center);
  const std::size_t small = problem.scene.pools().triangles.size();
  add_box(problem.scene, {0, 0, 0}, 2.0 * center);
  add_rays_at_mesh(problem, center, 0.25, count / 2, seed, 0, small);
  add_rays_at_mesh(problem, 0.5 * center, 0.25 * size, count - count / 2, seed + 1, 0, small);  // from the middle distance: at the small one
  std::ranges::fill(problem.set.expected.prim, kSomething);
  std::ranges::fill(problem.set.expected.t, kUnknownT);
  return finished(std::move(problem));
}
template Problem mixed_scales<10000>(int count, std::uint64_t seed);
template Problem mixed_scales<1000000>(int count, std::uint64_t seed);

}  // namespace raymeter::cases
