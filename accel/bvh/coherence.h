#pragma once

#include "core/ray/views.h"

namespace raymeter {

/// How much rays that stand together have in common, from 0 to 1: the length of the mean of sixteen neighbours' unit directions, the mean of `samples` such
/// groups (at most) spread over the rays. Rays that are no rays do not count. 1 where there are none.
[[nodiscard]] double coherence(const RayView& rays, int samples) noexcept;

}  // namespace raymeter
