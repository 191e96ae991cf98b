#pragma once

#include <vector>

#include "core/render/first_hit.h"
#include "core/render/frame_phases.h"
#include "core/render/image.h"
#include "core/render/occlusion.h"
#include "core/render/ray_counts.h"
#include "core/render/termination.h"
#include "core/scene/light_target.h"
#include "core/scene/scene.h"
#include "core/trace/intersector.h"

namespace raymeter {

struct RenderOptions {
  CameraModel model;
  Termination termination;
  int threads = 0;                                   ///< 0: all
  bool count = false;                                ///< the counting kernels trace
  Occlusion* occlusion = nullptr;                    ///< what answers shadow rays; null: the intersector
  bool bound = false;                                ///< Rendering::bound is worked out
  bool general = false;                              ///< runs what any scene may need, not only what this one does: to the same image, for comparison
  const std::vector<LightTarget>* lights = nullptr;  ///< the scene's, where frames share them; null: they are found
};

struct Rendering {
  Image image;
  RayCounts rays;
  DepthCounts depth;
  FrameTotals totals;
  /// Where asked for, [y * width + x]: how far the pixel is at most from that of the image which min_weight cuts nowhere. The sum over the rays that it cut off
  /// of weight times the largest radiance that such a ray can carry (core/render/radiance_bound.h), and what rounding adds.
  Column<glm::vec3> bound;
};

/// Renders a scene after Whitted 1980 (CACM 23(6)), under the conditions of the Standard Procedural Databases:
///  - at each hit, a shadow ray for each light that the surface faces; a light that is not blocked is shaded after Phong;
///  - a reflection ray at each hit on a surface that reflects or transmits, whatever its weight;
///  - a refraction ray at each hit on one that transmits; on total internal reflection the mirrored ray carries its share;
///  - an eye ray has depth 1, and rays are followed as `termination` says. What meets nothing sees the background.
/// Surfaces follow surface_rules() of the camera's convention. An opaque material's index of refraction is not looked at (NFF files carry 0 there).
///
/// Threads trace tiles of pixels beside each other, each tile on one thread from its eye rays to its last generation. A batch of rays has one origin and at
/// most one ray a pixel; its reflection rays are followed to their end, then its refraction rays. So no batch is larger than a tile, and two wait at each
/// depth: beside the image itself, memory depends on neither its size nor the tree of rays, but on the number of threads. An intersector that keeps its batch
/// and an occlusion that needs the frame's order get larger tiles one after the other, where threads share out what is traced and no more. The image and the
/// counts are the same on any number of threads. On several, the time of phases is what threads spent in each, as a share of the clock's.
[[nodiscard]] Rendering render(const Scene& scene, FirstHit& first_hit, Intersector& intersector, const RenderOptions& options);

}  // namespace raymeter
