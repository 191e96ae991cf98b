#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/base/column.h"
#include "core/ray/expected_hits.h"
#include "core/ray/ray_batch.h"
#include "core/ray/shadow_origins.h"
#include "core/ray/views.h"
#include "core/scene/camera.h"
#include "core/scene/origin_offset.h"
#include "core/scene/scene.h"
#include "core/trace/intersector.h"

namespace raymeter {

/// Sets of rays to measure with. All but random ones and those at meshes start from the eye rays of a camera model or from what those hit; a point that was hit
/// is recomputed in double (scene/surface.h), so that it does not depend on the tracer. Random numbers belong to (seed, kind, pixel, sample): sets depend on
/// neither threads nor order.
enum class RayKind : std::uint8_t {
  primary,     ///< eye rays, in the order of PixelOrder
  shadow,      ///< from each primary hit to each light that the surface faces on the eye's side, all hits for light 0, then for light 1...; the light is at
               ///< t = 1 and excluded (t_max one ulp below), lifted off the surfaces that it lies on (scene/light_target.h)
  reflection,  ///< the mirrored eye ray at each primary hit, whatever the material, about the shading normal
  ambient_occlusion,  ///< kAmbientOcclusionSamples per primary hit, cosine-weighted about the geometric normal on the eye's side, no longer than
                      ///< kAmbientOcclusionReach of the diagonal of the scene's box
  diffuse,            ///< one per primary hit, cosine-weighted as above, unbounded
  random,    ///< as many as pixels: uniform over all directed lines that meet the scene's box (the measure invariant under motions, for which the chance
             ///< to meet a convex body inside is the ratio of the areas: what the surface area heuristic assumes), from where they enter it
  vertices,  ///< as many as pixels: at vertices of triangles and polygons, picked at random, from inside where the surface is closed; see
             ///< generators_mesh.h
  edges,     ///< likewise, at points of their edges
  faces,     ///< likewise, at points of the triangles between neighbouring vertices
  invalid,   ///< the eye rays, every eighth of which is no ray: NaN or infinity in one of its numbers, no direction, or an empty interval
};
inline constexpr std::array kRayKinds{RayKind::primary, RayKind::shadow, RayKind::reflection, RayKind::ambient_occlusion,
                                      RayKind::diffuse, RayKind::random, RayKind::vertices,   RayKind::edges,
                                      RayKind::faces,   RayKind::invalid};

/// A kind, and by which rule its rays leave their surfaces. Where a rule is named, even the usual one, what the rays meet is held against what rays by the
/// bound meet (RaySet::expected; every ray is excused), and which flat primitive each leaves is known.
struct RayRecipe {
  RayKind kind;
  std::optional<OriginOffset> offset;
  RayRecipe(RayKind ray_kind, std::optional<OriginOffset> rule = std::nullopt) noexcept : kind(ray_kind), offset(rule) {}  // a kind is a recipe
};

[[nodiscard]] std::string_view name(RayKind kind) noexcept;
[[nodiscard]] std::optional<RayKind> ray_kind_from_name(std::string_view name) noexcept;
/// Whether rays of this kind leave surfaces, so that rules of their origin mean something.
[[nodiscard]] bool leaves_surfaces(RayKind kind) noexcept;
/// "diffuse", "diffuse:offset=1e-4": a kind's name, of those that leave surfaces perhaps with the text of an OriginOffset.
[[nodiscard]] std::optional<RayRecipe> ray_recipe_from_name(std::string_view name) noexcept;
[[nodiscard]] std::string name(const RayRecipe& recipe);

inline constexpr int kAmbientOcclusionSamples = 4;
inline constexpr double kAmbientOcclusionReach = 0.1;

struct RaySet {
  RayBatch rays;
  Query query = Query::closest;  ///< any for shadow and ambient_occlusion
  Column<std::int32_t> pixel;    ///< y * width + x of the eye ray that each ray comes from; of random rays their number
  ShadowOrigins origins = {};    ///< of shadow rays
  CameraModel model = {};        ///< of the eye rays
  ExpectedHits expected = {};    ///< where it is known
};

/// The eye rays through the given pixels, y * width + x. `rays` is resized.
void eye_rays(const CameraModel& model, const Column<std::int32_t>& pixels, RayBatch& rays, int threads = 1);

/// Makes a set; `tracer` finds the primary hits where the kind needs them.
[[nodiscard]] RaySet make_rays(const Scene& scene, const RayRecipe& recipe, const CameraModel& model, std::uint64_t seed, const Intersector& tracer,
                               int threads);

}  // namespace raymeter
