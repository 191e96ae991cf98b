#include "core/render/whitted.h"

#include <algorithm>
#include <vector>

#include <glm/geometric.hpp>

#include "core/ray/generators.h"
#include "core/ray/pixel_order.h"
#include "core/render/shading.h"
#include "core/trace/trace.h"

namespace raymeter {

namespace {

/// Rays that are traced and shaded together, at most: enough slices for many threads, and what memory is proportional to.
constexpr std::size_t kBatchRays = 64 * kSliceRays;

enum class Origin : std::uint8_t { eye, reflection, refraction };

struct Generation {
  RayBatch rays;
  Column<std::int32_t> slot;  ///< of the pixel in its band
  Column<float> weight;
  Column<Origin> origin;

  void push_back(const Ray& ray, std::int32_t pixel_slot, double ray_weight, Origin ray_origin) {
    rays.push_back(ray);
    slot.push_back(pixel_slot);
    weight.push_back(static_cast<float>(ray_weight));
    origin.push_back(ray_origin);
  }
  void append(const Generation& other) {
    rays.append(other.rays);
    slot.append(other.slot);
    weight.append(other.weight);
    origin.append(other.origin);
  }
};

/// Shadow rays towards one light, and what they bring to their pixels unless they are blocked.
struct ShadowRays {
  RayBatch rays;
  Column<std::int32_t> slot;
  Column<glm::vec3> radiance;

  void append(const ShadowRays& other) {
    rays.append(other.rays);
    slot.append(other.slot);
    radiance.append(other.radiance);
  }
};

/// What emit(batch, i) adds for each i below `count`, in the order of i whatever the threads.
template <class Batch, class Emit>
Batch gathered(std::size_t count, int threads, Emit emit) {
  std::vector<Batch> part(slice_count(count));
  for_each_slice(count, threads, [&](std::size_t slice, std::size_t first, std::size_t size) {
    for (std::size_t i = first; i < first + size; ++i) emit(part[slice], i);
  });
  Batch all;
  for (const Batch& batch : part) all.append(batch);
  return all;
}

class Whitted {
public:
  Whitted(const Scene& scene, FirstHit& first_hit, Intersector& intersector, const RenderOptions& options)
      : scene_(scene), first_hit_(first_hit), intersector_(intersector), options_(options), rules_(surface_rules(options.model.convention)) {}

  Rendering render() {
    const CameraModel& model = options_.model;
    out_.image = {model.width, model.height, Column<glm::vec3>(static_cast<std::size_t>(model.pixel_count()), glm::vec3(0))};
    if (!options_.termination.traces_eye_rays()) return std::move(out_);
    const PixelOrder order(model.width, model.height);
    for (std::int32_t block = 0; block < order.block_count();) {
      pixels_.clear();
      while (block < order.block_count() && pixels_.size() + PixelOrder::kBlock * PixelOrder::kBlock <= kBatchRays) order.append_block(block++, pixels_);
      render_band();
    }
    return std::move(out_);
  }

private:
  void render_band() {
    const std::size_t size = pixels_.size();
    sum_.assign(size, glm::dvec3(0));
    Generation eye;
    eye.rays = eye_rays(options_.model, pixels_, options_.threads);
    eye.slot.resize(size);
    for (std::size_t i = 0; i < size; ++i) eye.slot[i] = static_cast<std::int32_t>(i);
    eye.weight.resize(size, 1);
    eye.origin.resize(size, Origin::eye);
    follow(std::move(eye), 1);
    for (std::size_t i = 0; i < size; ++i) out_.image.pixel[static_cast<std::size_t>(pixels_[i])] = glm::vec3(sum_[i]);
  }

  /// Traces and shades the rays of a generation and all that come of them: deeper ones first, so that at most a batch and its children wait at each depth.
  void follow(Generation&& generation, int depth) {
    if (generation.rays.size() == 0) return;
    Generation next = trace_and_shade(std::move(generation), depth);
    if (next.rays.size() <= kBatchRays) return follow(std::move(next), depth + 1);
    for (std::size_t first = 0; first < next.rays.size(); first += kBatchRays) {
      Generation batch;
      for (std::size_t i = first; i < std::min(first + kBatchRays, next.rays.size()); ++i) {
        batch.push_back(next.rays[i], next.slot[i], double{next.weight[i]}, next.origin[i]);
      }
      follow(std::move(batch), depth + 1);
    }
  }

  Generation trace_and_shade(Generation rays, int depth) {
    HitBatch hits;
    if (depth == 1) {
      first_hit_.find(options_.model, pixels_, rays.rays, hits, options_.threads, options_.counters);
    } else {
      intersector_.prepare(rays.rays.view());
      trace_closest(intersector_, rays.rays, hits, options_.threads, options_.counters);
    }
    const std::vector<ShadingPoint> points = shading_points(rays, hits);
    for (const Light& light : scene_.lights) add_light(points, light);
    return depth < options_.termination.max_depth ? spawned(points, depth + 1) : Generation{};
  }

  /// Counts the rays, adds the background where they meet nothing, and looks at the surface where they do.
  std::vector<ShadingPoint> shading_points(const Generation& rays, const HitBatch& hits) {
    std::vector<std::size_t> met;
    for (std::size_t i = 0; i < hits.size(); ++i) {
      const bool hit = hits.prim[i] >= 0;
      count(rays.origin[i], hit);
      if (hit)
        met.push_back(i);
      else
        sum_[static_cast<std::size_t>(rays.slot[i])] += double{rays.weight[i]} * scene_.background;
    }
    std::vector<ShadingPoint> points(met.size());
    for_each_slice(met.size(), options_.threads, [&](std::size_t, std::size_t first, std::size_t size) {
      for (std::size_t k = first; k < first + size; ++k) {
        const std::size_t i = met[k];
        const Ray ray = rays.rays[i];
        ShadingPoint& point = points[k];
        point.surface = surface_at(scene_, ray, hits.t[i], hits.prim[i]);
        point.dir = {ray.dir[0], ray.dir[1], ray.dir[2]};
        point.normal = point.surface.shading;
        if (rules_.two_sided && glm::dot(point.normal, point.dir) > 0) point.normal = -point.normal;
        point.material = &scene_.material(hits.prim[i]);
        point.slot = rays.slot[i];
        point.weight = rays.weight[i];
      }
    });
    return points;
  }

  void count(Origin origin, bool hit) noexcept {
    RayCounts& counts = out_.rays;
    switch (origin) {
      case Origin::eye:
        ++counts.primary;
        counts.primary_hit += hit ? 1 : 0;
        break;
      case Origin::reflection:
        ++counts.reflection;
        counts.reflection_hit += hit ? 1 : 0;
        break;
      case Origin::refraction:
        ++counts.refraction;
        counts.refraction_hit += hit ? 1 : 0;
        break;
    }
  }

  void add_light(const std::vector<ShadingPoint>& points, const Light& light) {
    const ShadowRays shadow = gathered<ShadowRays>(points.size(), options_.threads, [&](ShadowRays& out, std::size_t i) {
      const ShadingPoint& point = points[i];
      if (!faces(point, light)) return;
      out.rays.push_back(spawn_ray_to(point.surface, light.position, rules_.distance_min));
      out.slot.push_back(point.slot);
      out.radiance.push_back(glm::vec3(double{point.weight} * phong(point, light)));
    });
    Column<std::int32_t> blocker;
    intersector_.prepare(shadow.rays.view());
    trace_any(intersector_, shadow.rays, blocker, options_.threads, options_.counters);
    out_.rays.shadow += static_cast<std::int64_t>(blocker.size());
    for (std::size_t i = 0; i < blocker.size(); ++i) {
      if (blocker[i] >= 0)
        ++out_.rays.shadow_blocked;
      else
        sum_[static_cast<std::size_t>(shadow.slot[i])] += glm::dvec3(shadow.radiance[i]);
    }
  }

  /// Reflection rays first, refraction rays after them: neighbours in a packet then have much in common.
  Generation spawned(const std::vector<ShadingPoint>& points, int depth) {
    struct Secondary {
      Generation generation;
      std::int64_t tir = 0;
      void append(const Secondary& other) {
        generation.append(other.generation);
        tir += other.tir;
      }
    };
    const auto spawn = [&](Secondary& out, const ShadingPoint& point, const glm::dvec3& dir, double share, Origin origin) {
      const double weight = double{point.weight} * share;
      if (!options_.termination.follows(depth, weight)) return;
      out.generation.push_back(spawn_ray(point.surface, dir, rules_.distance_min), point.slot, weight, origin);
    };
    Secondary all = gathered<Secondary>(points.size(), options_.threads, [&](Secondary& out, std::size_t i) {
      const ShadingPoint& point = points[i];
      const Material& material = *point.material;
      if (!material.reflects() && !material.transmits()) return;
      const bool total = material.transmits() && !transmitted(point);
      out.tir += total ? 1 : 0;
      spawn(out, point, mirrored(point), material.specular + (total ? material.transmittance : 0), Origin::reflection);
    });
    all.append(gathered<Secondary>(points.size(), options_.threads, [&](Secondary& out, std::size_t i) {
      const ShadingPoint& point = points[i];
      if (!point.material->transmits()) return;
      if (const auto dir = transmitted(point)) spawn(out, point, *dir, point.material->transmittance, Origin::refraction);
    }));
    out_.rays.tir += all.tir;
    return std::move(all.generation);
  }

  const Scene& scene_;
  FirstHit& first_hit_;
  Intersector& intersector_;
  const RenderOptions& options_;
  SurfaceRules rules_;
  Column<std::int32_t> pixels_;  ///< of the band
  std::vector<glm::dvec3> sum_;  ///< their radiance so far
  Rendering out_;
};

}  // namespace

Rendering render(const Scene& scene, FirstHit& first_hit, Intersector& intersector, const RenderOptions& options) {
  return Whitted(scene, first_hit, intersector, options).render();
}

}  // namespace raymeter
