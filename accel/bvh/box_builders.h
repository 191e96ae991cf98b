#pragma once

#include "accel/bvh/bvh_params.h"
#include "accel/bvh/bvh_tree.h"

namespace raymeter {

// Builders of hierarchies of boxes. Their trees do not depend on `threads` (0: all). Sources stand in the files build_<name>.cpp.

/// What leaves a tree is to have: those that cost less than a split, or those that collapse_wide() can use. Of triangles that fit a block it leaves the choice
/// to that as long as splitting them makes the sum of areas smaller; where it does not, they are a leaf.
enum class LeafUse { as_they_are, for_blocks };

/// Top-down, splits by the surface area heuristic over binned centres.
[[nodiscard]] BvhTree build_binned_sah(const Scene& scene, const SahParams& params, int threads, LeafUse use = LeafUse::as_they_are);

/// Top-down, every split weighed by the surface area heuristic.
[[nodiscard]] BvhTree build_sweep_sah(const Scene& scene, const SahParams& params, int threads);

/// Top-down, where splits may also cut primitives in two; references then outnumber primitives.
[[nodiscard]] BvhTree build_sbvh(const Scene& scene, const SahParams& sah, const SbvhParams& params, int threads);

/// Top-down along the Morton curve.
[[nodiscard]] BvhTree build_lbvh(const Scene& scene, const SahParams& params, int threads);

/// Bottom-up, merging near pairs along the Morton curve.
[[nodiscard]] BvhTree build_ploc(const Scene& scene, const SahParams& sah, const PlocParams& params, int threads);

}  // namespace raymeter
