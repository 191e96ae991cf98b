#include "core/render/tile_tracer.h"

#include <algorithm>
#include <array>
#include <chrono>

#include <glm/geometric.hpp>

#include "core/ray/generators.h"
#include "core/render/radiance_bound.h"
#include "core/trace/trace.h"

namespace raymeter {

namespace {

using Clock = std::chrono::steady_clock;

FramePhase phase_of(Origin origin) noexcept {
  constexpr std::array phases{FramePhase::first_hit, FramePhase::reflection, FramePhase::refraction};
  return phases[static_cast<std::size_t>(origin)];
}

void begin(Generation& generation, Origin origin, int depth, std::int32_t node, std::size_t most) {
  generation.origin = origin;
  generation.depth = depth;
  generation.node = node;
  generation.resize(most);
}

}  // namespace

void TileTracer::trace_tile(const Column<std::int32_t>& pixels) {
  const auto start = Clock::now();
  const double traced_before = totals_.sum().ms;
  const RenderOptions& options = frame_.options;
  const std::size_t size = pixels.size();
  sum_.assign(size, glm::dvec3(0));
  deepest_.assign(size, 0);
  if (options.bound) cut_.assign(size, glm::dvec3(0));
  eye_.resize(size);
  eye_rays(options.model, pixels, eye_.rays, threads_);
  for (std::size_t i = 0; i < size; ++i) eye_.slot[i] = static_cast<std::int32_t>(i);
  std::fill(eye_.weight.begin(), eye_.weight.end(), glm::vec3(1));
  follow(eye_, pixels);
  for (std::size_t i = 0; i < size; ++i) {
    const auto pixel = static_cast<std::size_t>(pixels[i]);
    frame_.image.pixel[pixel] = glm::vec3(sum_[i]);
    depth_.deepest_sum += deepest_[i];
    if (options.bound) frame_.bound[pixel] = bound_of(cut_[i], sum_[i], options.termination.max_depth);
  }
  const double all_ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  totals_[FramePhase::shading].ms += all_ms - (totals_.sum().ms - traced_before);
}

/// Traces and shades rays and all that come of them.
void TileTracer::follow(const Generation& rays, const Column<std::int32_t>& pixels) {
  if (rays.size() == 0) return;
  trace(rays, pixels);
  frame_.needs.shading() ? look_at_surfaces<true>(rays) : look_at_surfaces<false>(rays);
  for (std::size_t light = 0; light < frame_.scene.lights.size(); ++light) add_light(light, rays.node);
  if (rays.depth >= frame_.options.termination.max_depth) return;
  Children& children = children_[static_cast<std::size_t>(rays.depth)];
  if (frame_.needs.reflection || frame_.needs.refraction) reflect(rays, children.reflections);
  if (frame_.needs.refraction) refract(rays, children.refractions);
  follow(children.reflections, pixels);
  follow(children.refractions, pixels);
}

void TileTracer::trace(const Generation& rays, const Column<std::int32_t>& pixels) {
  hits_.resize(0);
  totals_.measure(phase_of(rays.origin), rays.size(), frame_.options.count, [&](Counters* counters) {
    if (rays.origin == Origin::eye) return frame_.first_hit.find(frame_.options.model, pixels, rays.rays, hits_, threads_, counters);
    frame_.intersector.prepare(rays.rays.view(), Query::closest, threads_);
    trace_closest(frame_.intersector, rays.rays, hits_, threads_, counters);
  });
  count(rays);
}

void TileTracer::count(const Generation& rays) {
  const auto all = static_cast<std::int64_t>(rays.size());
  const std::int64_t met = all - std::count(hits_.prim.begin(), hits_.prim.end(), -1);
  switch (rays.origin) {
    case Origin::eye:
      rays_.primary += all;
      rays_.primary_hit += met;
      break;
    case Origin::reflection:
      rays_.reflection += all;
      rays_.reflection_hit += met;
      break;
    case Origin::refraction:
      rays_.refraction += all;
      rays_.refraction_hit += met;
      break;
  }
  const auto depth = static_cast<std::size_t>(rays.depth);
  if (depth_.generation.size() < depth) depth_.generation.resize(depth);
  depth_.generation[depth - 1] += all;
}

/// Adds the background where rays meet nothing, and makes points of where they do, if surfaces matter.
template <bool kSurfaces>
void TileTracer::look_at_surfaces(const Generation& rays) {
  points_.clear();
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto slot = static_cast<std::size_t>(rays.slot[i]);
    deepest_[slot] = std::max(deepest_[slot], rays.depth);
    if (hits_.prim[i] < 0)
      sum_[slot] += glm::dvec3(rays.weight[i]) * frame_.scene.background;
    else if constexpr (kSurfaces)
      points_.push_back(shading_point(rays, i));
  }
}

ShadingPoint TileTracer::shading_point(const Generation& rays, std::size_t i) const {
  const Ray ray = rays.rays[i];
  ShadingPoint point;
  point.surface = surface_at(frame_.scene, ray, hits_.t[i], hits_.prim[i]);
  point.dir = {ray.dir[0], ray.dir[1], ray.dir[2]};
  point.normal = point.surface.shading;
  if (frame_.rules.two_sided && glm::dot(point.normal, point.dir) > 0) point.normal = -point.normal;
  point.material = &frame_.scene.material(hits_.prim[i]);
  point.slot = rays.slot[i];
  point.weight = rays.weight[i];
  point.prim = hits_.prim[i];
  return point;
}

void TileTracer::add_light(std::size_t light_number, std::int32_t node) {
  const Light& light = frame_.scene.lights[light_number];
  shadow_.resize(points_.size());
  shadow_.origins.node = node;
  std::size_t count = 0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const ShadingPoint& point = points_[i];
    if (!faces(point, light)) continue;
    shadow_.rays.set(count, spawn_ray_to(point.surface, frame_.lights[light_number], frame_.rules.distance_min));
    shadow_.origins.light[count] = static_cast<std::int32_t>(light_number);
    shadow_.origins.source[count] = point.prim;
    shadow_.point[count] = static_cast<std::int32_t>(i);
    ++count;
  }
  shadow_.resize(count);
  if (count == 0) return;
  blocker_.clear();
  totals_.measure(FramePhase::shadow, count, frame_.options.count,
                  [&](Counters* counters) { occlusion_.find(shadow_.rays, shadow_.origins, blocker_, threads_, counters); });
  rays_.shadow += static_cast<std::int64_t>(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (blocker_[i] >= 0) {
      ++rays_.shadow_blocked;
      continue;
    }
    const ShadingPoint& point = points_[static_cast<std::size_t>(shadow_.point[i])];
    sum_[static_cast<std::size_t>(point.slot)] += glm::dvec3(glm::vec3(glm::dvec3(point.weight) * phong(point, light)));
  }
}

void TileTracer::spawn(Generation& out, std::size_t& count, const ShadingPoint& point, const glm::dvec3& dir, double share) {
  const glm::vec3 weight(glm::dvec3(point.weight) * share);
  const Termination& termination = frame_.options.termination;
  if (!termination.follows(out.depth, std::max({weight.x, weight.y, weight.z}))) {
    if (frame_.options.bound)
      cut_[static_cast<std::size_t>(point.slot)] += largest_share(weight, frame_.largest[static_cast<std::size_t>(termination.max_depth - out.depth + 1)]);
    return;
  }
  out.set(count++, spawn_ray(point.surface, dir, frame_.rules.distance_min), point.slot, weight);
}

/// On total internal reflection the mirrored ray carries the transmitted one's share too.
void TileTracer::reflect(const Generation& rays, Generation& reflections) {
  begin(reflections, Origin::reflection, rays.depth + 1, RayTree::reflection(rays.node), points_.size());
  std::size_t count = 0;
  for (const ShadingPoint& point : points_) {
    const Material& material = *point.material;
    if (!material.reflects() && !material.transmits()) continue;
    const bool total = material.transmits() && !transmitted(point);
    if (total) ++rays_.tir;
    spawn(reflections, count, point, mirrored(point), material.specular + (total ? material.transmittance : 0));
  }
  reflections.resize(count);
}

void TileTracer::refract(const Generation& rays, Generation& refractions) {
  begin(refractions, Origin::refraction, rays.depth + 1, RayTree::refraction(rays.node), points_.size());
  std::size_t count = 0;
  for (const ShadingPoint& point : points_) {
    if (!point.material->transmits()) continue;
    if (const auto dir = transmitted(point)) spawn(refractions, count, point, *dir, point.material->transmittance);
  }
  refractions.resize(count);
}

}  // namespace raymeter
