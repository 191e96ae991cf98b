#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "core/render/generation.h"
#include "core/render/shading.h"
#include "core/render/whitted.h"
#include "core/scene/light_target.h"
#include "core/scene/scene_needs.h"

namespace raymeter {

/// What the tiles of a frame share.
struct TracedFrame {
  const Scene& scene;
  FirstHit& first_hit;
  Intersector& intersector;
  const RenderOptions& options;
  SceneNeeds needs;
  SurfaceRules rules;
  std::vector<LightTarget> lights;  ///< the scene's
  std::vector<glm::dvec3> largest;  ///< radiance by generations that are left, where bounds are worked out
  Image& image;
  Column<glm::vec3>& bound;
};

/// Traces tiles of a frame, one at a time, each from its eye rays to its last generation.
class TileTracer {
public:
  /// Traces batches on so many threads (0: all); all else is done on the calling one.
  TileTracer(const TracedFrame& frame, Occlusion& occlusion, int threads) : frame_(frame), occlusion_(occlusion), threads_(threads) {}

  /// Writes the image, and the bound where asked for, at the tile's pixels, y * width + x.
  void trace_tile(const Column<std::int32_t>& pixels);

  // Sums over the tiles that were traced.
  [[nodiscard]] const RayCounts& rays() const noexcept { return rays_; }
  [[nodiscard]] const DepthCounts& depth() const noexcept { return depth_; }
  [[nodiscard]] const FrameTotals& totals() const noexcept { return totals_; }

private:
  void follow(const Generation& rays, const Column<std::int32_t>& pixels);
  void trace(const Generation& rays, const Column<std::int32_t>& pixels);
  void count(const Generation& rays);
  template <bool kSurfaces>
  void look_at_surfaces(const Generation& rays);
  [[nodiscard]] ShadingPoint shading_point(const Generation& rays, std::size_t i) const;
  void add_light(std::size_t light_number, std::int32_t node);
  void spawn(Generation& out, std::size_t& count, const ShadingPoint& point, const glm::dvec3& dir, double share);
  void reflect(const Generation& rays, Generation& reflections);
  void refract(const Generation& rays, Generation& refractions);

  /// What waits at a depth.
  struct Children {
    Generation reflections, refractions;
  };

  const TracedFrame& frame_;
  Occlusion& occlusion_;
  int threads_;
  RayCounts rays_;
  DepthCounts depth_;
  FrameTotals totals_;
  // Of the tile.
  Generation eye_;
  std::vector<glm::dvec3> sum_;  ///< radiance of pixels so far
  std::vector<int> deepest_;     ///< the depth of their rays so far
  std::vector<glm::dvec3> cut_;  ///< what the rays that were cut off could have brought them
  std::vector<Children> children_ = std::vector<Children>(static_cast<std::size_t>(std::max(1, frame_.options.termination.max_depth)));
  // Of the generation at hand.
  HitBatch hits_;
  std::vector<ShadingPoint> points_;
  ShadowRays shadow_;
  Column<std::int32_t> blocker_;
};

}  // namespace raymeter
