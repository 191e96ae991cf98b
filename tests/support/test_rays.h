#pragma once

#include <cstdint>

#include "core/ray/ray_batch.h"
#include "core/scene/scene.h"
#include "tests/support/random.h"

namespace raymeter::test {

/// A ray with the double vectors rounded to float, over [0, inf].
[[nodiscard]] Ray make_ray(const glm::dvec3& org, const glm::dvec3& dir);

/// A point of the primitive: a vertex, a point of an edge, of the silhouette or of a rim, or one inside.
[[nodiscard]] glm::dvec3 point_of(const Scene& scene, PrimRef ref, Random& random);

/// Rays of a pinhole in front of the scene, in tiles of 8 x 8.
[[nodiscard]] RayBatch coherent_rays(const Scene& scene);

/// Rays that are hard to trace in this scene: random and axis-parallel ones with either zero; at vertices, points of edges, rims; from centres, surfaces and
/// corners of boxes; of directions as long as 2^-60..2^60; with bounded, negative, infinite and single-point intervals; invalid ones alone in a packet and many
/// in a row.
[[nodiscard]] RayBatch hard_rays(const Scene& scene, std::uint64_t seed);

/// The given rays with intervals that end, begin, or both, exactly at their hits; and that end and begin just beside them.
[[nodiscard]] RayBatch cut_at_hits(const RayBatch& rays, const HitBatch& hits);

/// What the tracer must take for invalid.
[[nodiscard]] bool valid(const Ray& ray) noexcept;

}  // namespace raymeter::test
