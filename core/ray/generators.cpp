#include "core/ray/generators.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <glm/geometric.hpp>

#include "core/base/random.h"
#include "core/bounds/aabb.h"
#include "core/ray/generators_mesh.h"
#include "core/ray/pixel_order.h"
#include "core/scene/surface.h"
#include "core/trace/trace.h"

namespace raymeter {

namespace {

using glm::dvec3;
constexpr std::array<std::string_view, kRayKinds.size()> kNames{"primary", "shadow", "reflection", "ambient_occlusion", "diffuse", "random", "vertices",
                                                                "edges",   "faces",  "invalid"};
constexpr std::string_view kOffset = ":offset=";

RaySet resized(std::size_t size, Query query) {
  RaySet set;
  set.rays.resize(size);
  set.pixel.resize(size);
  set.query = query;
  return set;
}

RandomStream stream(std::uint64_t seed, RayKind kind, std::int32_t pixel, int sample = 0) noexcept {
  const auto key = (static_cast<std::uint64_t>(kind) << 8 | static_cast<std::uint64_t>(sample)) << 32 | static_cast<std::uint32_t>(pixel);
  return RandomStream(seed, key);
}

/// Cosine-weighted about `normal` (unit): a uniform point of the disc, lifted to the hemisphere (Malley). The disc by rejection and an orthonormal frame
/// without trigonometry (Duff et al. 2017, JCGT 6(1)): only operations that IEEE 754 rounds correctly, so that every compiler and libm gives the same rays.
dvec3 cosine_direction(const dvec3& normal, RandomStream& random) noexcept {
  double x, y, radius2;
  do {
    x = 2 * random.uniform() - 1;
    y = 2 * random.uniform() - 1;
    radius2 = x * x + y * y;
  } while (radius2 >= 1);
  const double sign = std::copysign(1.0, normal.z);
  const double a = -1 / (sign + normal.z);
  const double b = normal.x * normal.y * a;
  const dvec3 tangent(1 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x);
  const dvec3 bitangent(b, sign + normal.y * normal.y * a, -normal.y);
  return x * tangent + y * bitangent + std::sqrt(1 - radius2) * normal;
}

struct PrimaryHit {
  std::int32_t prim;
  Surface surface;  ///< both normals turned to the eye
  dvec3 dir;
  std::int32_t pixel;
};

std::vector<PrimaryHit> primary_hits(const Scene& scene, const RaySet& primary, const Intersector& tracer, int threads) {
  HitBatch hits;
  trace_closest(tracer, primary.rays, hits, threads);
  std::vector<std::size_t> ray_of_hit;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (hits.prim[i] >= 0) ray_of_hit.push_back(i);
  }
  std::vector<PrimaryHit> found(ray_of_hit.size());
  for_each_slice(found.size(), threads, [&](std::size_t, std::size_t first, std::size_t count) {
    for (std::size_t k = first; k < first + count; ++k) {
      const std::size_t i = ray_of_hit[k];
      const Ray ray = primary.rays[i];
      const dvec3 dir(ray.dir[0], ray.dir[1], ray.dir[2]);
      Surface surface = surface_at(scene, ray, hits.t[i], hits.prim[i]);
      if (glm::dot(surface.geometric, dir) > 0) surface.geometric = -surface.geometric;
      if (glm::dot(surface.shading, dir) > 0) surface.shading = -surface.shading;
      found[k] = {hits.prim[i], surface, dir, primary.pixel[i]};
    }
  });
  return found;
}

RaySet primary_rays(const CameraModel& model, int threads) {
  const PixelOrder order(model.width, model.height);
  Column<std::int32_t> pixels;
  pixels.reserve(static_cast<std::size_t>(model.pixel_count()));
  for (std::int32_t block = 0; block < order.block_count(); ++block) order.append_block(block, pixels);
  RaySet set;
  set.model = model;
  eye_rays(model, pixels, set.rays, threads);
  set.pixel = std::move(pixels);
  return set;
}

/// Every eighth ray of a set made invalid, in one way or another.
RaySet with_invalid(RaySet set, std::uint64_t seed) {
  constexpr std::size_t kEvery = 8;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();
  set.expected.prim.resize(set.rays.size(), ExpectedHits::kUnknown);
  for (std::size_t i = kEvery - 1; i < set.rays.size(); i += kEvery) {
    Ray ray = set.rays[i];
    float* const field[8] = {ray.org, ray.org + 1, ray.org + 2, ray.dir, ray.dir + 1, ray.dir + 2, &ray.t_min, &ray.t_max};
    switch (const std::uint64_t how = stream(seed, RayKind::invalid, set.pixel[i]).bits() % 16) {
      case 14: std::fill(ray.dir, ray.dir + 3, 0.0f); break;
      case 15: ray.t_max = -1; break;
      default: *field[how % 8] = how < 8 ? kNan : kInf;  // of the eight with infinity six are invalid: the two above take the place of the others
    }
    set.rays.set(i, ray);
    set.expected.prim[i] = ExpectedHits::kNothing;
  }
  return set;
}

RaySet shadow_rays(const Scene& scene, const std::vector<PrimaryHit>& hits, int threads) {
  RaySet set = resized(0, Query::any);
  const std::vector<LightTarget> targets = light_targets(scene, scene.lights, threads);
  for (std::size_t light = 0; light < targets.size(); ++light) {
    for (const PrimaryHit& hit : hits) {
      if (glm::dot(hit.surface.shading, targets[light].light - hit.surface.point) <= 0) continue;
      set.rays.push_back(spawn_ray_to(hit.surface, targets[light]));
      set.pixel.push_back(hit.pixel);
      set.origins.push_back(static_cast<std::int32_t>(light), hit.prim);
    }
  }
  return set;
}

/// `samples` rays per hit, made by spawn(hit, sample).
template <class Spawn>
RaySet rays_from_hits(const std::vector<PrimaryHit>& hits, std::size_t samples, Query query, int threads, Spawn spawn) {
  RaySet set = resized(hits.size() * samples, query);
  for_each_slice(set.rays.size(), threads, [&](std::size_t, std::size_t first, std::size_t count) {
    for (std::size_t i = first; i < first + count; ++i) {
      const PrimaryHit& hit = hits[i / samples];
      set.rays.set(i, spawn(hit, static_cast<int>(i % samples)));
      set.pixel[i] = hit.pixel;
    }
  });
  return set;
}

Aabb scene_box(const Scene& scene) noexcept {
  Aabb box;
  for (std::int32_t prim = 0; prim < scene.prim_id_count(); ++prim) {
    if (!scene.prim(prim).dropped()) box.grow(tight_bounds(scene.pools(), scene.prim(prim)));
  }
  return box;
}

/// A line that meets a convex body enters it at a point that is uniform on the surface, in a direction that is cosine-weighted there.
RaySet random_rays(const Scene& scene, std::int32_t count, std::uint64_t seed) {
  const Aabb box = scene_box(scene);
  if (box.empty()) return {};
  const dvec3 low(box.min), extent = dvec3(box.max) - low;
  const std::array<double, 3> area{extent.y * extent.z, extent.z * extent.x, extent.x * extent.y};
  RaySet set = resized(static_cast<std::size_t>(count), Query::closest);
  for (std::int32_t i = 0; i < count; ++i) {
    RandomStream random = stream(seed, RayKind::random, i);
    double pick = random.uniform() * (area[0] + area[1] + area[2]);
    int axis = 0;
    while (axis < 2 && pick >= area[static_cast<std::size_t>(axis)]) pick -= area[static_cast<std::size_t>(axis++)];
    const bool high = (random.bits() & 1) != 0;
    dvec3 point = low + extent * dvec3(random.uniform(), random.uniform(), random.uniform());
    point[axis] = low[axis] + (high ? extent[axis] : 0.0);
    dvec3 inwards(0.0);
    inwards[axis] = high ? -1 : 1;
    const glm::vec3 org(point), dir(cosine_direction(inwards, random));
    set.rays.set(static_cast<std::size_t>(i), {{org.x, org.y, org.z}, 0, {dir.x, dir.y, dir.z}, std::numeric_limits<float>::infinity()});
    set.pixel[static_cast<std::size_t>(i)] = i;
  }
  return set;
}

/// Secondary rays from what eye rays hit.
RaySet rays_leaving(const Scene& scene, RayKind kind, const std::vector<PrimaryHit>& hits, std::uint64_t seed, int threads) {
  const auto bounce = [&](const PrimaryHit& hit, int sample) noexcept {
    RandomStream random = stream(seed, kind, hit.pixel, sample);
    return spawn_ray(hit.surface, cosine_direction(hit.surface.geometric, random));
  };
  switch (kind) {
    case RayKind::shadow: return shadow_rays(scene, hits, threads);
    case RayKind::reflection:
      return rays_from_hits(hits, 1, Query::closest, threads,
                            [](const PrimaryHit& hit, int) noexcept { return spawn_ray(hit.surface, glm::reflect(hit.dir, hit.surface.shading)); });
    case RayKind::ambient_occlusion: {
      const Aabb box = scene_box(scene);
      const auto reach = static_cast<float>(hits.empty() ? 0 : kAmbientOcclusionReach * glm::length(dvec3(box.max) - dvec3(box.min)));
      return rays_from_hits(hits, kAmbientOcclusionSamples, Query::any, threads, [&](const PrimaryHit& hit, int sample) noexcept {
        Ray ray = bounce(hit, sample);
        ray.t_max = reach;
        return ray;
      });
    }
    default: return rays_from_hits(hits, 1, Query::closest, threads, bounce);
  }
}

/// What the rays of a set meet, and what they leave.
ExpectedHits met_by(const Scene& scene, const RaySet& set, const std::vector<PrimaryHit>& hits, std::int64_t pixels, const Intersector& tracer, int threads) {
  const auto is_flat = [&](std::int32_t prim) { return scene.prim(prim).kind() == PrimKind::triangle || scene.prim(prim).kind() == PrimKind::polygon; };
  std::vector<std::int32_t> prim_at(static_cast<std::size_t>(pixels), -1);
  for (const PrimaryHit& hit : hits) prim_at[static_cast<std::size_t>(hit.pixel)] = is_flat(hit.prim) ? hit.prim : -1;
  ExpectedHits expected;
  if (set.query == Query::any) {
    trace_any(tracer, set.rays, expected.prim, threads);
    for (std::int32_t& prim : expected.prim) prim = prim < 0 ? ExpectedHits::kNothing : ExpectedHits::kSomething;
  } else {
    HitBatch met;
    trace_closest(tracer, set.rays, met, threads);
    expected.prim = std::move(met.prim);
  }
  for (const std::int32_t pixel : set.pixel) expected.source.push_back(prim_at[static_cast<std::size_t>(pixel)]);
  expected.excused.resize(set.rays.size(), true);
  return expected;
}

}  // namespace

bool leaves_surfaces(RayKind kind) noexcept {
  return kind == RayKind::shadow || kind == RayKind::reflection || kind == RayKind::ambient_occlusion || kind == RayKind::diffuse;
}

std::optional<RayRecipe> ray_recipe_from_name(std::string_view name) noexcept {
  const std::size_t at = name.find(kOffset);
  const std::optional<RayKind> kind = ray_kind_from_name(name.substr(0, at));
  if (!kind || at == std::string_view::npos) return kind ? std::optional<RayRecipe>(*kind) : std::nullopt;
  const std::optional<OriginOffset> offset = origin_offset_from_text(name.substr(at + kOffset.size()));
  return offset && leaves_surfaces(*kind) ? std::optional<RayRecipe>(RayRecipe{*kind, offset}) : std::nullopt;
}

std::string name(const RayRecipe& recipe) { return std::string(name(recipe.kind)) + (recipe.offset ? std::string(kOffset) + to_string(*recipe.offset) : ""); }

std::string_view name(RayKind kind) noexcept { return kNames[static_cast<std::size_t>(kind)]; }

std::optional<RayKind> ray_kind_from_name(std::string_view name) noexcept {
  const auto found = std::find(kNames.begin(), kNames.end(), name);
  if (found == kNames.end()) return std::nullopt;
  return kRayKinds[static_cast<std::size_t>(found - kNames.begin())];
}

void eye_rays(const CameraModel& model, const Column<std::int32_t>& pixels, RayBatch& rays, int threads) {
  const EyeRays eye(model);
  const glm::vec3 org(eye.eye());
  rays.resize(pixels.size());
  for_each_slice(pixels.size(), threads, [&](std::size_t, std::size_t first, std::size_t count) {
    for (std::size_t i = first; i < first + count; ++i) {
      const glm::vec3 dir(eye.direction(pixels[i] % model.width, pixels[i] / model.width));
      rays.set(i, {{org.x, org.y, org.z}, 0, {dir.x, dir.y, dir.z}, std::numeric_limits<float>::infinity()});
    }
  });
}

RaySet make_rays(const Scene& scene, const RayRecipe& recipe, const CameraModel& model, std::uint64_t seed, const Intersector& tracer, int threads) {
  const RayKind kind = recipe.kind;
  if (kind == RayKind::random) return random_rays(scene, model.pixel_count(), seed);
  if (kind == RayKind::vertices || kind == RayKind::edges || kind == RayKind::faces) return mesh_rays(scene, kind, model.pixel_count(), seed, tracer, threads);
  RaySet primary = primary_rays(model, threads);
  if (kind == RayKind::primary) return primary;
  if (kind == RayKind::invalid) return with_invalid(std::move(primary), seed);
  std::vector<PrimaryHit> hits = primary_hits(scene, primary, tracer, threads);
  RaySet set = rays_leaving(scene, kind, hits, seed, threads);
  if (!recipe.offset) return set;
  ExpectedHits expected = met_by(scene, set, hits, model.pixel_count(), tracer, threads);
  for (PrimaryHit& hit : hits) hit.surface = recipe.offset->lift(hit.surface);
  set = rays_leaving(scene, kind, hits, seed, threads);
  set.expected = std::move(expected);
  return set;
}

}  // namespace raymeter
