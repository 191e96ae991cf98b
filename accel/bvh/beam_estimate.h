#pragma once

#include <span>

#include "accel/bvh/wide_layout.h"
#include "core/ray/views.h"

namespace raymeter {

/// What the leaves of a hierarchy tell of the work of beams: with s^2 the mean projected area of a leaf's box (a quarter of its surface), 2 sum s / sum s^2 and
/// count / sum s^2.
struct LeafSizes {
  double per_width = 0;
  double per_area = 0;
};
[[nodiscard]] LeafSizes leaf_sizes(std::span<const WideNode> nodes);

/// How many leaves beams of sixteen neighbours meet for each that one of their rays meets, as expected before anything is traced. A beam of width w meets a
/// leaf of size s with probability in proportion to (s + w)^2, a ray to s^2, so that a beam meets 1 + w per_width + w^2 per_area times as many. The width is
/// that of the rays half-way between where they enter the scene's box (or begin) and where they leave it (or end), from four rays each of four groups of
/// sixteen spread over the slice; the mean, groups counting for 16 at most, as beams of rays that have nothing in common do. `box`: min x y z, max x y z. Rays
/// that are no rays do not count.
[[nodiscard]] double leaves_per_ray(const RayView& slice, const float* box, const LeafSizes& leaves) noexcept;

/// How wide the groups of 256 rays are whose beams go down together: the widest of a slice, where it begins or ends inside the box, relative to the box's
/// longest side. From four rays each.
[[nodiscard]] double group_width(const RayView& slice, const float* box) noexcept;

}  // namespace raymeter
