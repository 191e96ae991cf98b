#include "tests/support/test_rays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/bounds/aabb.h"

namespace raymeter::test {

namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Aabb box_of(const Scene& scene) {
  Aabb box;
  for (std::int32_t prim = 0; prim < scene.prim_id_count(); ++prim) {
    if (!scene.prim(prim).dropped()) box.grow(tight_bounds(scene.pools(), scene.prim(prim)));
  }
  if (box.empty()) box.grow(glm::vec3(0.0f));
  return box;
}

glm::dvec3 point(const FloatColumns3& columns, std::size_t i) { return {columns[0][i], columns[1][i], columns[2][i]}; }

glm::dvec3 across(const glm::dvec3& axis, Random& random) {
  const glm::dvec3 v = glm::cross(axis, random.direction());
  const double length = glm::length(v);
  return length > 0 ? v / length : glm::dvec3(1, 0, 0);
}

/// What the rays are aimed at and where they start.
struct Aims {
  Random random;
  Aabb box;
  glm::dvec3 center;
  double reach;  ///< half the diagonal
  std::vector<glm::dvec3> points;

  Aims(const Scene& scene, std::uint64_t seed) : random(seed), box(box_of(scene)) {
    center = (glm::dvec3(box.min) + glm::dvec3(box.max)) / 2.0;
    reach = std::max(glm::length(glm::dvec3(box.extent())) / 2, 1e-6);
    std::vector<PrimRef> refs;
    for (std::int32_t prim = 0; prim < scene.prim_id_count(); ++prim) {
      if (!scene.prim(prim).dropped()) refs.push_back(scene.prim(prim));
    }
    for (int k = 0; k < 200; ++k) points.push_back(refs.empty() ? random.in_cube() : point_of(scene, refs[random.below(refs.size())], random));
  }
  glm::dvec3 aim() { return points[random.below(points.size())]; }
  glm::dvec3 around() { return center + reach * random.in_cube(1.5); }
};

Ray invalid_ray(Ray ray, int how) {
  switch (how % 10) {
    case 0: ray.org[1] = kNan; break;
    case 1: ray.dir[2] = kNan; break;
    case 2: ray.t_min = kNan; break;
    case 3: ray.t_max = kNan; break;
    case 4: ray.org[0] = kInf; break;
    case 5: ray.dir[0] = -kInf; break;
    case 6: ray.dir[0] = ray.dir[1] = ray.dir[2] = 0; break;
    case 7: ray.dir[0] = ray.dir[1] = ray.dir[2] = -0.0f; break;
    case 8:
      ray.t_min = 2;
      ray.t_max = 1;
      break;
    default: ray.t_max = -kInf; break;
  }
  return ray;
}

}  // namespace

Ray make_ray(const glm::dvec3& org, const glm::dvec3& dir) {
  const glm::vec3 o(org), d(dir);
  return {{o.x, o.y, o.z}, 0, {d.x, d.y, d.z}, kInf};
}

glm::dvec3 point_of(const Scene& scene, PrimRef ref, Random& random) {
  const Pools& pools = scene.pools();
  const std::size_t i = ref.index;
  const int what = static_cast<int>(random.below(3));
  const double share = random.uniform();
  std::vector<glm::dvec3> outline;
  switch (ref.kind()) {
    case PrimKind::sphere: {
      const double r = double{pools.spheres.radius[i]};
      const glm::dvec3 axis(random.below(3) == 0, random.below(2) == 0, 1);
      return point(pools.spheres.center, i) + (what == 0 ? r * axis / glm::length(axis) : what == 1 ? r * random.direction() : r * share * random.direction());
    }
    case PrimKind::cone: {
      const glm::dvec3 axis = point(pools.cones.axis, i);
      const double y = what == 0 ? 0 : what == 1 ? 1 : share;
      const double r = (1 - y) * double{pools.cones.radius[0][i]} + y * double{pools.cones.radius[1][i]};
      return point(pools.cones.base, i) + y * axis + r * across(axis, random);
    }
    case PrimKind::triangle:
      for (std::size_t k = 0; k < 3; ++k) outline.push_back(point(pools.triangles.vertex[k], i));
      break;
    case PrimKind::polygon:
      for (auto k = pools.polygons.first_vertex[i]; k < pools.polygons.first_vertex[i + 1]; ++k) {
        outline.push_back(point(pools.polygons.vertex, static_cast<std::size_t>(k)));
      }
      break;
  }
  const std::size_t k = random.below(outline.size());
  const glm::dvec3 a = outline[k], b = outline[(k + 1) % outline.size()], c = outline[(k + 2) % outline.size()];
  if (what == 0) return a;
  if (what == 1) return a + share * (b - a);
  return a + share * (b - a) + (1 - share) * random.uniform() * (c - a);
}

bool valid(const Ray& ray) noexcept {
  const bool finite = std::all_of(ray.org, ray.org + 3, [](float x) { return std::isfinite(x); }) &&
                      std::all_of(ray.dir, ray.dir + 3, [](float x) { return std::isfinite(x); });
  return finite && (ray.dir[0] != 0 || ray.dir[1] != 0 || ray.dir[2] != 0) && ray.t_min <= ray.t_max;
}

RayBatch coherent_rays(const Scene& scene) {
  const Aims aims(scene, 1);
  constexpr int kSize = 32, kTile = 8;
  const glm::dvec3 eye = aims.center + aims.reach * glm::dvec3(0.3, 0.4, 2.5);
  const glm::dvec3 view = glm::normalize(aims.center - eye), right = glm::normalize(glm::cross(view, {0, 1, 0})), up = glm::cross(right, view);
  RayBatch rays;
  for (int i = 0; i < kSize * kSize; ++i) {
    const int tile = i / (kTile * kTile), in_tile = i % (kTile * kTile);
    const int x = tile % (kSize / kTile) * kTile + in_tile % kTile, y = tile / (kSize / kTile) * kTile + in_tile / kTile;
    const double u = (2 * x + 1.0) / kSize - 1, v = (2 * y + 1.0) / kSize - 1;
    rays.push_back(make_ray(eye, view + 0.4 * u * right + 0.4 * v * up));
  }
  return rays;
}

RayBatch hard_rays(const Scene& scene, std::uint64_t seed) {
  Aims aims(scene, seed);
  Random& random = aims.random;
  RayBatch rays;
  const auto add = [&](const glm::dvec3& org, const glm::dvec3& dir) { rays.push_back(make_ray(org, dir)); };
  for (int k = 0; k < 150; ++k) add(aims.around(), random.direction());
  for (int k = 0; k < 150; ++k) {
    const glm::dvec3 at = aims.aim();
    glm::dvec3 axis(k & 8 ? -0.0 : 0.0, k & 16 ? -0.0 : 0.0, k & 32 ? -0.0 : 0.0), start = at;
    axis[k % 3] = k % 2 == 0 ? 1 : -1;
    start[k % 3] -= 3 * aims.reach * axis[k % 3];
    add(start, axis);
  }
  for (int k = 0; k < 200; ++k) {
    const glm::dvec3 org = aims.around();
    add(org, aims.aim() - org);
  }
  for (int k = 0; k < 60; ++k) {  // far away
    const glm::dvec3 org = aims.center + 1e3 * aims.reach * random.direction();
    add(org, aims.aim() - org);
  }
  for (int k = 0; k < 100; ++k) {  // from surfaces, from inside, from the box's corners
    const glm::dvec3 low(aims.box.min), high(aims.box.max);
    const glm::dvec3 corner(k & 1 ? low.x : high.x, k & 2 ? low.y : high.y, k & 4 ? low.z : high.z);
    const glm::dvec3 org = k % 4 == 0 ? aims.center : k % 4 == 1 ? corner : aims.aim();
    add(org, k % 3 == 0 ? aims.aim() - org : k % 3 == 1 ? random.direction() : glm::round(random.in_cube(1.4)));
  }
  const std::size_t plain = rays.size();
  for (std::size_t k = 0; k < plain; ++k) {
    if (k % 3 != 0) continue;
    Ray ray = rays[k];
    const float scale = std::ldexp(1.0f, static_cast<int>(random.below(121)) - 60);
    for (float& d : ray.dir) d *= scale;
    rays.push_back(ray);
  }
  for (std::size_t k = 0; k < plain; k += 2) {
    Ray ray = rays[k];
    const float length = std::hypot(ray.dir[0], ray.dir[1], ray.dir[2]);
    const float unit = length > 0 ? static_cast<float>(aims.reach) / length : 1;
    switch (k / 2 % 6) {
      case 0: ray.t_max = unit * static_cast<float>(random.uniform(0, 4)); break;
      case 1: ray.t_min = -unit * 3; break;
      case 2: ray.t_min = -kInf; break;
      case 3: ray.t_min = -0.0f; break;
      case 4: ray.t_min = unit * static_cast<float>(random.uniform(0, 2)); break;
      default:
        ray.t_min = -unit * 10;
        ray.t_max = -unit / 2;
        break;
    }
    rays.push_back(ray);
  }
  const std::size_t valid_count = rays.size();
  for (std::size_t k = 5; k < valid_count; k += 41) rays.set(k, invalid_ray(rays[k], static_cast<int>(k)));
  for (int k = 0; k < 140; ++k) rays.push_back(invalid_ray(rays[static_cast<std::size_t>(k)], k));
  for (int k = 0; k < 30; ++k) rays.push_back(rays[static_cast<std::size_t>(k)]);
  return rays;
}

RayBatch cut_at_hits(const RayBatch& rays, const HitBatch& hits) {
  RayBatch cut;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (hits.prim[i] < 0) continue;
    const float t = hits.t[i], before = std::nextafter(t, -kInf), after = std::nextafter(t, kInf);
    const Ray ray = rays[i];
    const std::array<std::array<float, 2>, 5> ends{{{ray.t_min, t}, {t, t}, {t, kInf}, {std::min(ray.t_min, before), before}, {after, kInf}}};
    Ray shorter = ray;
    shorter.t_min = ends[i % 5][0];
    shorter.t_max = ends[i % 5][1];
    cut.push_back(shorter);
  }
  return cut;
}

}  // namespace raymeter::test
