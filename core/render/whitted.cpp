#include "core/render/whitted.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <optional>
#include <vector>

#include <glm/geometric.hpp>

#include "core/ray/generators.h"
#include "core/ray/pixel_order.h"
#include "core/render/radiance_bound.h"
#include "core/render/wavefront.h"
#include "core/scene/scene_needs.h"
#include "core/trace/trace.h"

namespace raymeter {

namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) { return std::chrono::duration<double, std::milli>(Clock::now() - start).count(); }

/// Pixels that are traced together, at most: enough slices for many threads, and what memory is proportional to.
constexpr std::size_t kBandPixels = 64 * kSliceRays;

FramePhase phase_of(Origin origin) noexcept {
  constexpr std::array phases{FramePhase::first_hit, FramePhase::reflection, FramePhase::refraction};
  return phases[static_cast<std::size_t>(origin)];
}

class Whitted {
public:
  Whitted(const Scene& scene, FirstHit& first_hit, Intersector& intersector, const RenderOptions& options)
      : scene_(scene), first_hit_(first_hit), intersector_(intersector), options_(options), rules_(surface_rules(options.model.convention)) {
    if (options.occlusion != nullptr) occlusion_ = options.occlusion;
  }

  Rendering render() {
    const auto start = Clock::now();
    const CameraModel& model = options_.model;
    out_.image = {model.width, model.height, Column<glm::vec3>(static_cast<std::size_t>(model.pixel_count()), glm::vec3(0))};
    if (options_.bound) {
      largest_ = largest_radiance(scene_, options_.termination.max_depth);
      out_.bound.resize(out_.image.pixel.size(), glm::vec3(0));
    }
    in_phase(FramePhase::first_hit, 0, [&](Counters*) { first_hit_.begin(model, options_.threads); });
    in_phase(FramePhase::shadow, 0, [&](Counters*) { occlusion_->begin(); });
    const PixelOrder order(model.width, model.height);
    for (std::int32_t block = 0; block < order.block_count() && options_.termination.traces_eye_rays();) {
      pixels_.clear();
      while (block < order.block_count() && pixels_.size() + PixelOrder::kBlock * PixelOrder::kBlock <= kBandPixels) order.append_block(block++, pixels_);
      render_band();
    }
    out_.totals[FramePhase::shading].ms = ms_since(start) - out_.totals.sum().ms;
    return std::move(out_);
  }

private:
  void render_band() {
    const std::size_t size = pixels_.size();
    sum_.assign(size, glm::dvec3(0));
    deepest_.assign(size, 0);
    if (options_.bound) cut_.assign(size, glm::dvec3(0));
    Generation eye;
    eye.rays = eye_rays(options_.model, pixels_, options_.threads);
    eye.slot.resize(size);
    for (std::size_t i = 0; i < size; ++i) eye.slot[i] = static_cast<std::int32_t>(i);
    eye.weight.resize(size, glm::vec3(1));
    follow(eye);
    std::atomic<std::int64_t> deepest_sum = 0;
    for_each_slice(size, options_.threads, [&](std::size_t, std::size_t first, std::size_t count) {
      std::int64_t sum = 0;
      for (std::size_t i = first; i < first + count; ++i) {
        const auto pixel = static_cast<std::size_t>(pixels_[i]);
        out_.image.pixel[pixel] = glm::vec3(sum_[i]);
        sum += deepest_[i];
        if (options_.bound) out_.bound[pixel] = bound_of(cut_[i], sum_[i], options_.termination.max_depth);
      }
      deepest_sum += sum;
    });
    out_.depth.deepest_sum += deepest_sum;
  }

  /// Traces and shades rays and all that come of them.
  void follow(const Generation& rays) {
    if (rays.size() == 0) return;
    trace(rays);
    needs_.shading() ? look_at_surfaces<true>(rays) : look_at_surfaces<false>(rays);
    for (std::size_t light = 0; light < scene_.lights.size(); ++light) add_light(light, rays.node);
    if (rays.depth >= options_.termination.max_depth) return;
    Children& children = children_[static_cast<std::size_t>(rays.depth)];
    if (needs_.reflection || needs_.refraction) reflect(rays, children.reflections);
    if (needs_.refraction) refract(rays, children.refractions);
    follow(children.reflections);
    follow(children.refractions);
  }

  /// Calls trace(counters or null), which traces so many rays, by the clock of a phase.
  template <class Trace>
  void in_phase(FramePhase phase, std::size_t rays, Trace&& trace) {
    PhaseTotals& totals = out_.totals[phase];
    const auto start = Clock::now();
    trace(options_.count ? &totals.counters : nullptr);
    totals.ms += ms_since(start);
    totals.rays += static_cast<std::int64_t>(rays);
  }

  void trace(const Generation& rays) {
    hits_.resize(0);
    in_phase(phase_of(rays.origin), rays.size(), [&](Counters* counters) {
      if (rays.origin == Origin::eye) return first_hit_.find(options_.model, pixels_, rays.rays, hits_, options_.threads, counters);
      intersector_.prepare(rays.rays.view(), Query::closest, options_.threads);
      trace_closest(intersector_, rays.rays, hits_, options_.threads, counters);
    });
    count(rays);
  }

  void count(const Generation& rays) {
    const auto all = static_cast<std::int64_t>(rays.size());
    const std::int64_t met = all - std::count(hits_.prim.begin(), hits_.prim.end(), -1);
    RayCounts& counts = out_.rays;
    switch (rays.origin) {
      case Origin::eye:
        counts.primary += all;
        counts.primary_hit += met;
        break;
      case Origin::reflection:
        counts.reflection += all;
        counts.reflection_hit += met;
        break;
      case Origin::refraction:
        counts.refraction += all;
        counts.refraction_hit += met;
        break;
    }
    const auto depth = static_cast<std::size_t>(rays.depth);
    if (out_.depth.generation.size() < depth) out_.depth.generation.resize(depth);
    out_.depth.generation[depth - 1] += all;
  }

  /// Adds the background where rays meet nothing, and makes points of where they do, if surfaces matter.
  template <bool kSurfaces>
  void look_at_surfaces(const Generation& rays) {
    points_.begin(rays.size());
    for_each_slice(rays.size(), options_.threads, [&](std::size_t slice, std::size_t first, std::size_t size) {
      std::vector<ShadingPoint>& points = points_.of_slice[slice];
      points.clear();
      if constexpr (kSurfaces) points.reserve(size);
      for (std::size_t i = first; i < first + size; ++i) {
        const auto slot = static_cast<std::size_t>(rays.slot[i]);
        deepest_[slot] = std::max(deepest_[slot], rays.depth);
        if (hits_.prim[i] < 0)
          sum_[slot] += glm::dvec3(rays.weight[i]) * scene_.background;
        else if constexpr (kSurfaces)
          points.push_back(shading_point(rays, i, hits_.t[i], hits_.prim[i]));
      }
    });
  }

  [[nodiscard]] ShadingPoint shading_point(const Generation& rays, std::size_t i, float t, std::int32_t prim) const {
    const Ray ray = rays.rays[i];
    ShadingPoint point;
    point.surface = surface_at(scene_, ray, t, prim);
    point.dir = {ray.dir[0], ray.dir[1], ray.dir[2]};
    point.normal = point.surface.shading;
    if (rules_.two_sided && glm::dot(point.normal, point.dir) > 0) point.normal = -point.normal;
    point.material = &scene_.material(prim);
    point.slot = rays.slot[i];
    point.weight = rays.weight[i];
    point.prim = prim;
    return point;
  }

  void add_light(std::size_t light_number, std::int32_t node) {
    const Light& light = scene_.lights[light_number];
    emit_parts(points_, options_.threads, shadow_parts_, [&](ShadowRays& out, const ShadingPoint& point) {
      if (!faces(point, light)) return;
      out.rays.push_back(spawn_ray_to(point.surface, light.position, rules_.distance_min));
      out.origins.push_back(static_cast<std::int32_t>(light_number), point.prim);
      out.slot.push_back(point.slot);
      out.radiance.push_back(glm::vec3(glm::dvec3(point.weight) * phong(point, light)));
    });
    join_parts(points_, options_.threads, shadow_parts_, shadow_);
    shadow_.origins.node = node;
    blocker_.clear();
    in_phase(FramePhase::shadow, shadow_.size(),
             [&](Counters* counters) { occlusion_->find(shadow_.rays, shadow_.origins, blocker_, options_.threads, counters); });
    const auto all = static_cast<std::int64_t>(shadow_.size());
    out_.rays.shadow += all;
    out_.rays.shadow_blocked += all - std::count(blocker_.begin(), blocker_.end(), -1);
    for_each_slice(shadow_.size(), options_.threads, [&](std::size_t, std::size_t first, std::size_t size) {
      for (std::size_t i = first; i < first + size; ++i) {
        if (blocker_[i] < 0) sum_[static_cast<std::size_t>(shadow_.slot[i])] += glm::dvec3(shadow_.radiance[i]);
      }
    });
  }

  void spawn(Generation& out, const ShadingPoint& point, const glm::dvec3& dir, double share, int depth) {
    const glm::vec3 weight(glm::dvec3(point.weight) * share);
    if (!options_.termination.follows(depth, std::max({weight.x, weight.y, weight.z}))) {
      if (options_.bound)
        cut_[static_cast<std::size_t>(point.slot)] += largest_share(weight, largest_[static_cast<std::size_t>(options_.termination.max_depth - depth + 1)]);
      return;
    }
    out.push_back(spawn_ray(point.surface, dir, rules_.distance_min), point.slot, weight);
  }

  /// On total internal reflection the mirrored ray carries the transmitted one's share too.
  void reflect(const Generation& rays, Generation& reflections) {
    begin(reflections, Origin::reflection, rays.depth + 1, RayTree::reflection(rays.node));
    std::atomic<std::int64_t> tir = 0;
    emit_parts(points_, options_.threads, parts_, [&](Generation& out, const ShadingPoint& point) {
      const Material& material = *point.material;
      if (!material.reflects() && !material.transmits()) return;
      const bool total = material.transmits() && !transmitted(point);
      if (total) tir.fetch_add(1, std::memory_order_relaxed);
      spawn(out, point, mirrored(point), material.specular + (total ? material.transmittance : 0), reflections.depth);
    });
    out_.rays.tir += tir;
    join_parts(points_, options_.threads, parts_, reflections);
  }

  void refract(const Generation& rays, Generation& refractions) {
    begin(refractions, Origin::refraction, rays.depth + 1, RayTree::refraction(rays.node));
    emit_parts(points_, options_.threads, parts_, [&](Generation& out, const ShadingPoint& point) {
      if (!point.material->transmits()) return;
      if (const auto dir = transmitted(point)) spawn(out, point, *dir, point.material->transmittance, refractions.depth);
    });
    join_parts(points_, options_.threads, parts_, refractions);
  }

  static void begin(Generation& generation, Origin origin, int depth, std::int32_t node) noexcept {
    generation.origin = origin;
    generation.depth = depth;
    generation.node = node;
  }

  /// What waits at a depth.
  struct Children {
    Generation reflections, refractions;
  };

  const Scene& scene_;
  FirstHit& first_hit_;
  Intersector& intersector_;
  TracedOcclusion traced_{intersector_};
  Occlusion* occlusion_ = &traced_;
  const RenderOptions& options_;
  SceneNeeds needs_ = options_.general ? all_needs() : needs_of(scene_);
  SurfaceRules rules_;
  Column<std::int32_t> pixels_;  ///< of the band
  std::vector<glm::dvec3> sum_;  ///< their radiance so far
  std::vector<int> deepest_;     ///< the depth of their rays so far
  std::vector<glm::dvec3> cut_;  ///< what the rays that were cut off could have brought them
  std::vector<glm::dvec3> largest_;
  // Of the generation at hand, and of each depth.
  HitBatch hits_;
  ShadingPoints points_;
  std::vector<ShadowRays> shadow_parts_;
  ShadowRays shadow_;
  Column<std::int32_t> blocker_;
  std::vector<Generation> parts_;
  std::vector<Children> children_{static_cast<std::size_t>(std::max(1, options_.termination.max_depth))};
  Rendering out_;
};

}  // namespace

Rendering render(const Scene& scene, FirstHit& first_hit, Intersector& intersector, const RenderOptions& options) {
  return Whitted(scene, first_hit, intersector, options).render();
}

}  // namespace raymeter
