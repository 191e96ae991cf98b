#pragma once

#include <cstdint>

#include "core/ray/generators.h"

namespace raymeter {

/// Whether triangles and polygons alone bound a solid: each edge, by the coordinates of its ends, belongs to an even number of them, not counting pairs that
/// lie on one another. Then every ray from inside meets the surface, whatever edge or vertex it passes.
[[nodiscard]] bool is_closed(const Scene& scene);

/// `count` rays of RayKind vertices, edges or faces. They start in the middle of chords that lines cut out of the scene, which is inside of what is closed;
/// where the scene is, that they hit something is known. None where the scene has no triangles and polygons, or lines cut no chords out of it.
[[nodiscard]] RaySet mesh_rays(const Scene& scene, RayKind kind, std::int32_t count, std::uint64_t seed, const Intersector& tracer, int threads);

}  // namespace raymeter
