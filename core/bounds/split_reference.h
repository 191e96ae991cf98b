#pragma once

#include <cstdint>

#include "core/bounds/aabb.h"
#include "core/scene/scene.h"

namespace raymeter {

/// A primitive, or the part of one that a spatial split left in a node: a box around that part, not padded.
struct SplitReference {
  Aabb box;
  PrimRef ref;
};

/// The parts of a reference on both sides of the plane x_axis = position; a side that the primitive does not reach has an empty box. A triangle's parts have
/// the boxes of the cut triangle, those of other kinds are cut with their box, which is all that their kernels promise to keep to.
struct CutReference {
  Aabb left;
  Aabb right;
};
[[nodiscard]] CutReference cut(const Pools& pools, const SplitReference& reference, int axis, float position) noexcept;

/// The box of the part of a triangle that lies in `box`, which it meets; empty where there is none. Clipped by all six planes: after cuts on several axes this
/// is tighter than what `cut` leaves (Havran 2000, "split clipping").
[[nodiscard]] Aabb clipped(const Pools& pools, PrimRef triangle, const Aabb& box) noexcept;

/// The part's box, grown by what the whole primitive's would be (kBoundsPadding). A hit lies within kPrimitiveError of a point of the primitive, and that point
/// in one of its parts.
[[nodiscard]] Aabb padded_part(const Pools& pools, const SplitReference& reference) noexcept;

}  // namespace raymeter
