#include "experiments/cases/recipes.h"

#include "experiments/verify/oracle.h"

namespace raymeter::cases {

Ray ray(const glm::dvec3& org, const glm::dvec3& dir, float t_min, float t_max) {
  const glm::vec3 o(org), d(dir);
  return {{o.x, o.y, o.z}, t_min, {d.x, d.y, d.z}, t_max};
}

void add(Problem& problem, const Ray& ray, std::int32_t prim, double t) {
  problem.set.rays.push_back(ray);
  problem.set.expected.push_back(prim, t);
}

Problem finished(Problem problem) {
  problem.scene.finish();
  return problem;
}

Problem solved(Problem problem) {
  problem.scene.finish();
  const Oracle oracle(problem.scene);
  ExpectedHits& expected = problem.set.expected;
  for (std::size_t i = 0; i < problem.set.rays.size(); ++i) {
    if (expected.prim[i] != ExpectedHits::kUnknown) continue;
    const auto hit = oracle.nearest(problem.set.rays[i]);
    expected.prim[i] = hit ? hit->prim : ExpectedHits::kNothing;
    expected.t[i] = hit ? hit->t : kUnknownT;
  }
  return problem;
}

void add_rectangle(Scene& scene, const glm::dvec3& at, const glm::dvec3& x, const glm::dvec3& y) {
  scene.add_triangle(at, at + x, at + x + y);
  scene.add_triangle(at, at + x + y, at + y);
}

Corners corners_at(const glm::dvec3& low, const std::array<glm::dvec3, 3>& axes) {
  Corners corners;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    corners[k] = low;
    for (std::size_t a = 0; a < 3; ++a) corners[k] += k >> a & 1 ? axes[a] : glm::dvec3(0.0);
  }
  return corners;
}

void add_box(Scene& scene, const Corners& corners) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t x = std::size_t{1} << (axis + 1) % 3, y = std::size_t{1} << (axis + 2) % 3;
    for (const std::size_t at : {std::size_t{0}, std::size_t{1} << axis}) {
      scene.add_triangle(corners[at], corners[at | x], corners[at | x | y]);
      scene.add_triangle(corners[at], corners[at | x | y], corners[at | y]);
    }
  }
}

void add_box(Scene& scene, const glm::dvec3& low, const glm::dvec3& high) {
  const glm::dvec3 extent = high - low;
  add_box(scene, corners_at(low, {glm::dvec3(extent.x, 0, 0), glm::dvec3(0, extent.y, 0), glm::dvec3(0, 0, extent.z)}));
}

}  // namespace raymeter::cases
