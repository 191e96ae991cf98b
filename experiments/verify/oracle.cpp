#include "experiments/verify/oracle.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/error_bounds.h"
#include "experiments/verify/cone_truth.h"
#include "experiments/verify/facet.h"
#include "experiments/verify/polygon_truth.h"
#include "experiments/verify/sphere_truth.h"
#include "experiments/verify/triangle_truth.h"

namespace raymeter {

namespace {

using namespace verify;

bool valid(const Ray& ray) noexcept {
  bool finite = true, moves = false;
  for (int a = 0; a < 3; ++a) {
    finite = finite && std::isfinite(ray.org[a]) && std::isfinite(ray.dir[a]);
    moves = moves || ray.dir[a] != 0;
  }
  return finite && moves && ray.t_min <= ray.t_max;
}

/// A t that is no float is no hit.
Ray bounded(Ray ray) noexcept {
  constexpr float kLargest = std::numeric_limits<float>::max();
  ray.t_min = std::isnan(ray.t_min) ? ray.t_min : std::max(ray.t_min, -kLargest);
  ray.t_max = std::isnan(ray.t_max) ? ray.t_max : std::min(ray.t_max, kLargest);
  return ray;
}

std::vector<std::array<float, 3>> vertices_of(const Pools& pools, PrimRef ref) {
  if (ref.kind() == PrimKind::polygon) return polygon_at(pools, ref.index).vertex;
  const TriangleShape shape = triangle_at(pools, ref.index);
  std::vector<std::array<float, 3>> out;
  for (const auto& v : shape.vertex) out.push_back({v[0], v[1], v[2]});
  return out;
}

bool is_facet(PrimRef ref) noexcept { return ref.kind() == PrimKind::triangle || ref.kind() == PrimKind::polygon; }

Facet facet_of(const Pools& pools, PrimRef ref, std::int32_t prim, const RaySpace& space) {
  Facet facet{prim, {}};
  for (const auto& vertex : vertices_of(pools, ref)) facet.outline.push_back(space.see(vertex));
  return facet;
}

/// t of a facet whose outline the ray passes.
double border_depth(const Pools& pools, PrimRef ref, const Facet& facet, const Ray& ray) {
  return ref.kind() == PrimKind::polygon ? depth(polygon_at(pools, ref.index), point(ray.org), point(ray.dir)) : facet.border_depth();
}

TrueHits hits_of(const Pools& pools, PrimRef ref, const Ray& ray) {
  switch (ref.kind()) {
    case PrimKind::sphere: return true_hits(ray, sphere_at(pools, ref.index));
    case PrimKind::triangle: return true_hits(ray, triangle_at(pools, ref.index));
    case PrimKind::polygon: return true_hits(ray, polygon_at(pools, ref.index));
    case PrimKind::cone: return true_hits(ray, cone_at(pools, ref.index));
  }
  return {};
}

/// Centre and radius of a sphere that holds the primitive, good to 2^-40.
void bound(const Pools& pools, PrimRef ref, double (&center)[3], double& radius) {
  if (ref.kind() == PrimKind::sphere) {
    const SphereShape shape = sphere_at(pools, ref.index);
    for (int a = 0; a < 3; ++a) center[a] = double{shape.center[a]};
    radius = double{shape.radius};
  } else if (ref.kind() == PrimKind::cone) {
    const ConeShape shape = cone_at(pools, ref.index);
    for (int a = 0; a < 3; ++a) center[a] = double{shape.base[a]} + double{shape.axis[a]} / 2;
    radius = std::hypot(length(point(shape.axis)) / 2, double{std::max(shape.radius[0], shape.radius[1])});
  } else {
    const auto vertices = vertices_of(pools, ref);
    radius = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const auto [low, high] = std::minmax_element(vertices.begin(), vertices.end(), [a](const auto& v, const auto& w) { return v[a] < w[a]; });
      center[a] = (double{(*low)[a]} + double{(*high)[a]}) / 2;
    }
    for (const auto& v : vertices) radius = std::max(radius, std::hypot(double{v[0]} - center[0], double{v[1]} - center[1], double{v[2]} - center[2]));
  }
}

double delta(const Point& org, const Point& p, double radius) noexcept { return double{kSurfaceError} * (length(minus(p, org)) + 2 * radius); }

}  // namespace

double ulps(float t, double exact) noexcept {
  const float nearest = std::abs(static_cast<float>(exact));
  return std::abs(double{t} - exact) / (double{std::nextafterf(nearest, std::numeric_limits<float>::infinity())} - double{nearest});
}

struct Oracle::Near {
  struct Hit {
    std::int32_t prim;
    double t;
    bool may_be_lost;
  };
  std::vector<Hit> hits;
  std::vector<Facet> border;  ///< facets whose outline passes within the band
};

Oracle::Oracle(const Scene& scene) : scene_(scene), bounds_of_(static_cast<std::size_t>(scene.prim_id_count()), -1) {
  bounds_.reserve(static_cast<std::size_t>(scene.prim_count()));
  for (std::int32_t prim = 0; prim < scene.prim_id_count(); ++prim) {
    const PrimRef ref = scene.prim(prim);
    if (ref.dropped()) continue;
    Bounds sphere{{}, 0, prim};
    bound(scene.pools(), ref, sphere.center, sphere.radius);
    bounds_of_[static_cast<std::size_t>(prim)] = static_cast<std::int32_t>(bounds_.size());
    bounds_.push_back(sphere);
  }
}

Oracle::Near Oracle::near(const Ray& ray, double t_end) const {
  Near near;
  const Point org = point(ray.org), dir = point(ray.dir);
  const double dir2 = dot(dir, dir), dir_length = std::sqrt(dir2), per_dir2 = 1 / dir2;
  const RaySpace space(ray);
  for (const Bounds& bounds : bounds_) {
    const Point to{bounds.center[0] - org[0], bounds.center[1] - org[1], bounds.center[2] - org[2]};
    const double t_nearest = dot(to, dir) * per_dir2;
    const Point across = along(to, -t_nearest, dir);
    const double reach = bounds.radius + 0x1p-16 * (std::abs(to[0]) + std::abs(to[1]) + std::abs(to[2]) + bounds.radius);
    if (dot(across, across) > reach * reach) continue;
    if ((t_nearest - t_end) * dir_length > reach || (double{ray.t_min} - t_nearest) * dir_length > reach) continue;

    const PrimRef ref = scene_.prim(bounds.prim);
    bool may_be_lost = false;
    if (is_facet(ref)) {
      Facet facet = facet_of(scene_.pools(), ref, bounds.prim, space);
      const Facet::Place place = facet.place();
      if (place == Facet::Place::outside) continue;
      may_be_lost = place == Facet::Place::border;
      if (may_be_lost) near.border.push_back(std::move(facet));
    }
    const TrueHits hits = hits_of(scene_.pools(), ref, ray);
    for (std::size_t k = 0; k < static_cast<std::size_t>(hits.count); ++k) {
      const double shift = delta(org, along(org, hits.t[k], dir), bounds.radius);
      if (ref.kind() == PrimKind::sphere) may_be_lost = depth_inside(sphere_at(scene_.pools(), ref.index), org, dir) <= shift;
      if (ref.kind() == PrimKind::cone) may_be_lost = near_border(cone_at(scene_.pools(), ref.index), org, dir, hits.t[k], shift);
      near.hits.push_back({bounds.prim, hits.t[k], may_be_lost});
    }
  }
  return near;
}

bool Oracle::on_surface(const Ray& ray, std::int32_t prim, double t) const {
  const PrimRef ref = scene_.prim(prim);
  const Point org = point(ray.org), dir = point(ray.dir), p = along(org, t, dir);
  const double allowed = delta(org, p, bounds_[static_cast<std::size_t>(bounds_of_[static_cast<std::size_t>(prim)])].radius);
  switch (ref.kind()) {
    case PrimKind::sphere: return distance(sphere_at(scene_.pools(), ref.index), p) <= allowed;
    case PrimKind::triangle: return distance(triangle_at(scene_.pools(), ref.index), p) <= allowed;
    case PrimKind::polygon: return distance(polygon_at(scene_.pools(), ref.index), org, dir, t) <= allowed;
    case PrimKind::cone: return distance(cone_at(scene_.pools(), ref.index), p) <= allowed;
  }
  return false;
}

bool Oracle::reaches(const Ray& ray, std::int32_t prim, double t, double end) const {
  if (!std::isfinite(end) || !on_surface(ray, prim, end)) return false;
  if (is_facet(scene_.prim(prim))) return true;  // convex along the ray
  // Inside a sphere or cone the distance from the surface is concave along the ray: what the quarters say holds in between up to a small factor.
  for (const double share : {0.25, 0.5, 0.75}) {
    if (!on_surface(ray, prim, t + share * (end - t))) return false;
  }
  return true;
}

bool Oracle::hit_is_due(const Ray& ray, const Near& near, double t_end) const {
  const double t_min{ray.t_min};
  for (const Near::Hit& hit : near.hits) {
    if (hit.t < t_end && !hit.may_be_lost && !reaches(ray, hit.prim, hit.t, t_end) && !reaches(ray, hit.prim, hit.t, t_min)) return true;
  }
  if (near.border.empty()) return false;
  for (const auto& group : covering_groups(near.border)) {
    const bool due = std::all_of(group.begin(), group.end(), [&](std::size_t i) {
      const Facet& facet = near.border[i];
      const double t = border_depth(scene_.pools(), scene_.prim(facet.prim), facet, ray);
      return t > t_min && t < t_end && !reaches(ray, facet.prim, t, t_min) && !reaches(ray, facet.prim, t, t_end);
    });
    if (due) return true;
  }
  return false;
}

std::optional<Oracle::Exact> Oracle::nearest(const Ray& given) const {
  const Ray ray = bounded(given);
  if (!valid(ray)) return std::nullopt;
  const std::vector<Near::Hit> hits = near(ray, double{ray.t_max}).hits;
  if (hits.empty()) return std::nullopt;
  const double t = std::ranges::min(hits, {}, &Near::Hit::t).t;
  std::int32_t prim = std::numeric_limits<std::int32_t>::max();
  for (const Near::Hit& hit : hits) {
    if (hit.t <= t + 0x1p-36 * std::abs(t)) prim = std::min(prim, hit.prim);
  }
  return Exact{prim, t};
}

Check Oracle::closest(const Ray& given, float t, std::int32_t prim) const {
  const Ray ray = bounded(given);
  const bool hit = prim >= 0;
  if (!valid(ray)) return {hit ? Verdict::false_hit : Verdict::correct};
  if (!hit) return {hit_is_due(ray, near(ray, double{ray.t_max}), double{ray.t_max}) ? Verdict::false_miss : Verdict::correct};
  if (prim >= scene_.prim_id_count() || scene_.prim(prim).dropped()) return {Verdict::false_hit};
  if (!(std::isfinite(t) && t >= ray.t_min && t <= ray.t_max) || !on_surface(ray, prim, double{t})) return {Verdict::false_hit};

  const PrimRef ref = scene_.prim(prim);
  if (is_facet(ref) && facet_of(scene_.pools(), ref, prim, RaySpace(ray)).place() == Facet::Place::outside) return {Verdict::false_hit};
  if (hit_is_due(ray, near(ray, double{t}), double{t})) return {Verdict::wrong_prim};
  Check check;
  const TrueHits own = hits_of(scene_.pools(), ref, ray);
  for (std::size_t k = 0; k < static_cast<std::size_t>(own.count); ++k) {
    const double error = ulps(t, own.t[k]);
    if (check.t_ulp < 0 || error < check.t_ulp) check.t_ulp = error;
  }
  return check;
}

Check Oracle::any(const Ray& given, std::int32_t blocker) const {
  const Ray ray = bounded(given);
  if (blocker < 0) return closest(ray, std::numeric_limits<float>::infinity(), -1);
  if (!valid(ray) || blocker >= scene_.prim_id_count() || scene_.prim(blocker).dropped()) return {Verdict::false_hit};
  const PrimRef ref = scene_.prim(blocker);
  if (hits_of(scene_.pools(), ref, ray).count > 0) return {};
  // No exact hit: one within delta will do, where the ray comes nearest or at an end of its interval.
  const Point org = point(ray.org), dir = point(ray.dir);
  std::vector<double> approaches{double{ray.t_min}, double{ray.t_max}};
  if (is_facet(ref)) {
    const Facet facet = facet_of(scene_.pools(), ref, blocker, RaySpace(ray));
    const Facet::Place place = facet.place();
    if (place == Facet::Place::outside) return {Verdict::false_hit};
    if (place == Facet::Place::border) approaches.push_back(border_depth(scene_.pools(), ref, facet, ray));
  } else if (ref.kind() == PrimKind::cone) {
    for (const double t : near_approaches(cone_at(scene_.pools(), ref.index), org, dir)) approaches.push_back(t);
  } else {
    approaches.push_back(dot(minus(point(sphere_at(scene_.pools(), ref.index).center), org), dir) / dot(dir, dir));
  }
  for (const double t : approaches) {
    if (std::isfinite(t) && t >= double{ray.t_min} && t <= double{ray.t_max} && on_surface(ray, blocker, t)) return {};
  }
  return {Verdict::false_hit};
}

}  // namespace raymeter
