#pragma once

#include "accel/bvh/bvh_params.h"
#include "accel/bvh/bvh_tree.h"

namespace raymeter {

// Builders of hierarchies of boxes. Their trees do not depend on `threads` (0: all). Sources stand in the files build_<name>.cpp.

/// Top-down, splits by the surface area heuristic over binned centres.
[[nodiscard]] BvhTree build_binned_sah(const Scene& scene, const SahParams& params, int threads);

/// Top-down, every split weighed by the surface area heuristic.
[[nodiscard]] BvhTree build_sweep_sah(const Scene& scene, const SahParams& params, int threads);

/// Top-down, where splits may also cut primitives in two; references then outnumber primitives.
[[nodiscard]] BvhTree build_sbvh(const Scene& scene, const SahParams& sah, const SbvhParams& params, int threads);

/// Top-down along the Morton curve.
[[nodiscard]] BvhTree build_lbvh(const Scene& scene, const SahParams& params, int threads);

/// Bottom-up, merging near pairs along the Morton curve.
[[nodiscard]] BvhTree build_ploc(const Scene& scene, const SahParams& sah, const PlocParams& params, int threads);

}  // namespace raymeter
