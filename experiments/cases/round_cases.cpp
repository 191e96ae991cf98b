// Spheres and cones: far, huge, tangent, nested.

#include "experiments/cases/recipes.h"

namespace raymeter::cases {

namespace {

constexpr std::int32_t kNothing = ExpectedHits::kNothing;
constexpr std::int32_t kUnknown = ExpectedHits::kUnknown;

constexpr double power_of_ten(int exponent) { return exponent == 0 ? 1 : 10 * power_of_ten(exponent - 1); }

}  // namespace

Problem coincident_spheres(int, std::uint64_t) {
  Problem problem;
  for (int k = 0; k < 20'000; ++k) problem.scene.add_sphere({0.25, 0.5, 0.75}, 1);
  for (int k = 0; k < 16; ++k) add(problem, ray({0.25 + 0.06 * k, 0.5, 4}, {0, 0, -1}), 0);
  for (int k = 0; k < 4; ++k) add(problem, ray({1.3, 0.5 * k, 4}, {0, 0, -1}), kNothing);
  return finished(std::move(problem));
}

Problem concentric(int, std::uint64_t) {
  constexpr int kShells = 256;
  Problem problem;
  for (int k = kShells; k >= 1; --k) {  // of one half width: the sphere inside the cube
    add_box(problem.scene, glm::dvec3(-k), glm::dvec3(k));
    problem.scene.add_sphere({0, 0, 0}, k - 0.5);
  }
  const auto first_of = [](int k) { return 13 * (kShells - k); };
  for (glm::length_t axis = 0; axis < 3; ++axis) {
    for (int k = 0; k <= kShells; k += 8) {
      // From between shells outwards: the sphere of the next, then its cube.
      glm::dvec3 org(0.0), dir(0.0);
      org[axis] = k + 0.25;
      dir[axis] = 1;
      if (k < kShells) add(problem, ray(org, dir), first_of(k + 1) + 12, 0.25);
      if (k > 0) add(problem, ray(org, -dir), ExpectedHits::kSomething, 0.25);
    }
  }
  return finished(std::move(problem));
}

/// The measurement of Haines, Guenther, Akenine-Moeller 2019, whose formula has 0, 0, 2, 31, 241 and 2364 false misses and false hits of 200,000 at 10, 100,
/// ...
template <int kDistance>
Problem far_sphere(int count, std::uint64_t seed) {
  Problem problem;
  problem.scene.add_sphere({0, 0, 0}, 1);
  Random random(seed);
  for (int k = 0; k < count; ++k) {
    const glm::dvec3 away = random.direction(), across = glm::normalize(glm::cross(away, random.direction()));
    const glm::dvec3 org(glm::vec3(power_of_ten(kDistance) * away));
    add(problem, ray(org, glm::normalize(1.2 * std::sqrt(random.uniform()) * across - org)), kUnknown);
  }
  return solved(std::move(problem));
}
template Problem far_sphere<1>(int count, std::uint64_t seed);
template Problem far_sphere<2>(int count, std::uint64_t seed);
template Problem far_sphere<3>(int count, std::uint64_t seed);
template Problem far_sphere<4>(int count, std::uint64_t seed);
template Problem far_sphere<5>(int count, std::uint64_t seed);
template Problem far_sphere<6>(int count, std::uint64_t seed);

template <int kRadius>
Problem ground_sphere(int count, std::uint64_t seed) {
  Problem problem;
  const double radius = power_of_ten(kRadius);
  problem.scene.add_sphere({0, -radius, 0}, radius);
  Random random(seed);
  for (int k = 0; k < count; ++k) {
    const glm::dvec3 dir = random.direction();
    add(problem, ray({0, 1, 0}, {dir.x, -0.1 - std::abs(dir.y), dir.z}), kUnknown);
  }
  return solved(std::move(problem));
}
template Problem ground_sphere<3>(int count, std::uint64_t seed);
template Problem ground_sphere<5>(int count, std::uint64_t seed);
template Problem ground_sphere<7>(int count, std::uint64_t seed);

Problem tangents(int, std::uint64_t) {
  Problem problem;
  problem.scene.add_sphere({0, 0, 0}, 1);
  for (int k = -64; k <= 64; ++k) {
    const float x = static_cast<float>(1 + k * 0x1p-24);
    for (const float at : {x, -x}) {
      add(problem, ray({at, 0, -10}, {0, 0, 1}), x <= 1 ? 0 : kNothing, x == 1 ? 10 : kUnknownT);
      add(problem, ray({-10, at, 0}, {1, 0, 0}), x <= 1 ? 0 : kNothing, x == 1 ? 10 : kUnknownT);
    }
  }
  return finished(std::move(problem));
}

Problem sphere_ends(int, std::uint64_t) {
  Problem problem;
  Scene& scene = problem.scene;
  scene.add_sphere({0, 0, 0}, 1);
  scene.add_sphere({8, 0, 0}, 0);  // a point, which rays through it hit
  scene.add_sphere({16, 0, 0}, 1e-20);
  scene.add_sphere({0, 0, 0}, 0x1p60);  // about all others
  for (const double length : {1.0, 2.0, 0.5, 1024.0}) {
    add(problem, ray({0, 0, 0}, {0, 0, length}), 0, 1 / length);
    add(problem, ray({0, 0, 1}, {0, 0, length}), 0, 0);
    add(problem, ray({0, 0, 1}, {0, 0, -length}), 0, 0);
    add(problem, ray({0, 0, 1}, {0, 0, -length}, 0x1p-60f), 0, 2 / length);
    add(problem, ray({8, 0, -4}, {0, 0, length}), 1, 4 / length);
    add(problem, ray({8, 0x1p-149, -4}, {0, 0, length}), 3, 0x1p60 / length);
    add(problem, ray({16, 0, -4}, {0, 0, length}), 2, 4 / length);
    add(problem, ray({16, 1e-18, -4}, {0, 0, length}), 3, 0x1p60 / length);
    add(problem, ray({4, 0x1p61, 0}, {0, -length, 0}), 3, 0x1p60 / length);
    add(problem, ray({4, 0x1p61, 0}, {0, length, 0}), kNothing);
  }
  return finished(std::move(problem));
}

Problem nested_spheres(int, std::uint64_t) {
  constexpr int kShells = 64;
  Problem problem;
  for (int k = 0; k < kShells; ++k) problem.scene.add_sphere({0, 0, 0}, 1 + k * 0x1p-20);
  for (int k = kShells - 1; k >= 0; --k) {
    const double t = 4 - (1 + k * 0x1p-20);  // exact in float, as the next one is
    const auto begin = static_cast<float>(t - 0x1p-21);
    add(problem, ray({0, 0, -4}, {0, 0, 1}, begin), k, t);
    add(problem, ray({4, 0, 0}, {-1, 0, 0}, begin), k, t);
    add(problem, ray({0, 0, 0}, {0, 1, 0}, static_cast<float>(1 + k * 0x1p-20 - 0x1p-22)), k, 1 + k * 0x1p-20);
  }
  return finished(std::move(problem));
}

Problem cones(int count, std::uint64_t seed) {
  Problem problem;
  Scene& scene = problem.scene;
  Random random(14);
  for (int k = 0; k < 60; ++k) {
    const glm::dvec3 base(glm::vec3(6.0 * random.in_cube()));
    const double r = random.uniform(0.001, 0.2);
    const glm::dvec3 axis = k % 4 == 0 ? glm::dvec3(0, 0.5, 0) : random.uniform(0.05, 1) * random.direction();
    scene.add_cone(base, r, base + axis, k % 3 == 0 ? r : k % 3 == 1 ? 0 : r / 2);
  }
  scene.finish();
  Random aims(seed);
  const auto at = [](const FloatColumns3& columns, std::size_t i) { return glm::dvec3(columns[0][i], columns[1][i], columns[2][i]); };
  for (int k = 0; k < count; ++k) {  // at rims, apexes and sides; along sides and axes
    const std::size_t i = aims.below(scene.pools().cones.size());
    const glm::dvec3 base = at(scene.pools().cones.base, i), axis = at(scene.pools().cones.axis, i);
    const double y = k % 3 == 0 ? 0 : k % 3 == 1 ? 1 : aims.uniform();
    const double r = (1 - y) * double{scene.pools().cones.radius[0][i]} + y * double{scene.pools().cones.radius[1][i]};
    const glm::dvec3 across = glm::normalize(glm::cross(axis, aims.direction()));
    const glm::dvec3 target = base + y * axis + r * across, away = k % 5 == 0 ? glm::normalize(axis) : aims.direction();
    const glm::dvec3 org(glm::vec3(target + std::pow(10.0, aims.uniform(-1, 3)) * away));
    problem.set.rays.push_back(ray(org, target - org));
  }
  return problem;
}

}  // namespace raymeter::cases
